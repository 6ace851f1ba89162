#pragma once

#include <array>
#include <vector>

#include "mapping/interpretation/fronts/fixtures.h"
#include "mapping/interpretation/fronts/parameters.h"

namespace loci::mapping {

/// Evidence that a straight line divides a part of a face.
struct LineEvidence {
  enum class Kind {
    none,
    seam,  ///< a groove, a dark or coloured line, or missing returns between two equal sides
    step   ///< the sides differ in depth, intensity or colour
  };
  Kind kind = Kind::none;
  double position = 0;  ///< u of an upright line, v of a level one
  double width = 0;     ///< of the seam, metres
  double z = 0;         ///< sum of the standard scores of its chunks over the root of their number
  double share = 0;     ///< of its length that shows it
  double weakest = 0;  ///< minimum over any 20 cm of the mean score of a chunk, relative to the mean over all
  bool relief = false;  ///< the evidence is depth or missing returns, not intensity or colour
  double rise = 0;      ///< step: depth beyond the line minus depth before it, metres
};

/// Evidence for seams and edges in a face. Along every row and column of the raster, chunks of 4 cm are
/// tested for a dip or a step against their flanks in every channel (depth, missing returns, intensity,
/// colours). A line sums its chunks, each with limited influence: a seam shows along its whole length, a
/// scratch does not.
class SeamMap {
 public:
  /// Does not use rays that pass or touch a fixture.
  SeamMap(const FaceRays& rays, const std::vector<FaceFixture>& fixtures);

  /// Evidence of an upright line (constant u) between two v, or a level one (constant v) between two u.
  LineEvidence line(bool upright, double position, double from, double to) const;

  /// The same line with its exact position, kind, width and rise, from sums over its length between `from`
  /// and `to`. The width of a seam is that of its gap, 0 below the resolution of beam and registration.
  LineEvidence refine(bool upright, const LineEvidence& line, double from, double to) const;

  struct Coverage {
    double known = 0;     ///< share of its cells that a ray met
    double returned = 0;  ///< share of its rays that came back
    double face = 0;      ///< share of the known cells that are face
    double depth = 0;     ///< mean of these
  };
  Coverage coverage(const FaceRect& rect) const;
  /// {known, face of known} for each column (`columns`) or row of a rectangle.
  std::vector<std::array<float, 2>> coverage_of(const FaceRect& rect, bool columns) const;

  const FaceGrid& grid() const { return grid_; }

 private:
  static constexpr size_t kChannels = 6;
  enum Channel : size_t { depth, missing, intensity, red, green, blue };

  /// Sums of one channel over cells.
  struct Sums {
    std::vector<float> sum, weight;
  };
  /// Scores of lines in one direction by chunk and position, as integrals over chunks.
  struct Scores {
    int positions = 0, chunks = 0;
    struct Entry {
      float z = 0, shown = 0, count = 0;
    };
    /// [channel][width or step][chunk * positions + position], integrated over chunks.
    std::array<std::array<std::vector<Entry>, kSeams.half_widths.size() + 1>, kChannels> integrals;
  };
  /// Means of a line's neighbourhood, cell by cell across it.
  struct Profile {
    using Values = std::array<double, 2 * kSeams.profile_cells + 1>;
    double origin = 0;  ///< of the grid across the line, metres
    int centre = 0;     ///< cell of the line
    std::array<Values, kChannels> mean{}, weight{};

    static size_t index(int offset) { return static_cast<size_t>(offset + kSeams.profile_cells); }
    /// Weighted mean of a channel between two offsets from the centre, both included.
    double mean_between(size_t channel, int first, int last) const;
  };
  Profile profile(bool upright, int centre, double from, double to) const;
  /// Sets kind, position and width by a seam; false when a step explains the profile better.
  bool place_seam(const Profile& profile, LineEvidence& line) const;
  void place_step(const Profile& profile, LineEvidence& line) const;
  double unit(size_t channel) const;
  void gather(const FaceRays& rays, const std::vector<FaceFixture>& fixtures);
  /// Robust standard deviation of a ray, from differences between neighbouring blocks of cells.
  double noise_of(size_t channel, int columns, int rows) const;
  void estimate_noise();
  void score(bool upright, Scores& scores) const;
  void score_channel(bool upright, size_t channel, Scores& scores) const;
  static double weakest(const std::vector<Scores::Entry>& integral, size_t positions, size_t position,
                        int first_chunk, int last_chunk, double mean);
  LineEvidence strongest(const Scores& scores, int position, int first_chunk, int last_chunk) const;

  FaceGrid grid_;
  std::array<Sums, kChannels> sums_;
  std::array<double, kChannels> variance_{};
  std::vector<uint8_t> face_;  ///< 0 unknown, 1 face, 2 no face
  Scores upright_, level_;
};

}  // namespace loci::mapping

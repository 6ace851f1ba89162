#pragma once

#include <array>
#include <vector>

#include "mapping/interpretation/fixtures.h"

namespace loci::mapping {

/// How well a straight line across a part of a face parts it.
struct LineEvidence {
  enum class Kind {
    none,
    seam,  ///< a groove, a dark or coloured line, missing returns between two sides that are alike
    step   ///< the sides differ in depth, intensity or colour
  };
  Kind kind = Kind::none;
  double position = 0;  ///< u of an upright line, v of a level one
  double width = 0;     ///< of the seam, metres
  double z = 0;         ///< standard scores of its chunks, summed and divided by the root of their number
  double share = 0;     ///< of its length that shows it
  double weakest = 0;   ///< least mean score of a chunk over any 20 cm of it, against the mean over all
  bool relief = false;  ///< the evidence is depth or missing returns, not intensity or colour
  double rise = 0;      ///< step: depth beyond the line minus depth before it, metres
};

/// Evidence for seams and edges in a face. Along every row and column of the raster chunks of 4 cm are tested
/// for a dip or a step against their flanks in every channel (depth, missing returns, intensity, colours); a
/// line gathers its chunks, each with limited influence: a seam runs along its whole length, a scratch or an
/// object's edge does not.
class SeamMap {
 public:
  /// Rays that pass or touch a fixture are not used.
  SeamMap(const FaceRays& rays, const std::vector<FaceFixture>& fixtures);

  /// Evidence of an upright line (constant u) between two heights, or a level one (constant v) between two u.
  LineEvidence upright(double u, double v0, double v1) const;
  LineEvidence level(double v, double u0, double u1) const;

  /// The same line with its exact position, kind, width and rise, from sums over its length between `from`
  /// and `to`. The width of a seam is that of its gap, 0 when it is narrower than beam and registration can
  /// tell.
  LineEvidence refine(bool upright, const LineEvidence& line, double from, double to) const;

  /// How a rectangle looks in the mean.
  struct Look {
    double known = 0;     ///< share of its cells that a ray met
    double returned = 0;  ///< share of its rays that came back
    double face = 0;      ///< share of the known cells that are face
    double depth = 0;     ///< mean of these
  };
  Look look(const FaceRect& rect) const;
  /// Shares of columns (along u) of a rectangle: {known, face of known}.
  std::vector<std::array<float, 2>> column_shares(const FaceRect& rect) const;
  std::vector<std::array<float, 2>> row_shares(const FaceRect& rect) const;

  const FaceGrid& grid() const { return grid_; }

 private:
  static constexpr size_t kChannels = 6;
  static constexpr int kChunk = 10;  ///< cells
  static constexpr std::array<int, 3> kHalfWidths = {0, 1, 3};
  enum Channel : size_t { depth, missing, intensity, red, green, blue };

  /// Sums of one channel over cells.
  struct Sums {
    std::vector<float> sum, weight;
  };
  /// Scores of lines in one direction: for each chunk and each position along the other direction; as
  /// integrals over chunks.
  struct Scores {
    int positions = 0, chunks = 0;
    struct Entry {
      float z = 0, shown = 0, count = 0;
    };
    /// [channel][width or step][chunk * positions + position], integrated over chunks.
    std::array<std::array<std::vector<Entry>, kHalfWidths.size() + 1>, kChannels> integrals;
  };
  /// Means of a line's neighbourhood, cell by cell across it.
  struct Profile {
    static constexpr int kReach = 8;  ///< cells to each side
    std::array<std::array<double, 2 * kReach + 1>, kChannels> mean{}, weight{};
  };
  Profile profile(bool upright, int centre, double from, double to) const;
  double unit(size_t channel) const;
  void gather(const FaceRays& rays, const std::vector<FaceFixture>& fixtures);
  /// Robust standard deviation of a ray, from differences between neighbouring blocks of cells.
  double scatter(size_t channel, int columns, int rows) const;
  void estimate_noise();
  void score(bool upright, Scores& scores) const;
  void score_channel(bool upright, size_t channel, Scores& scores) const;
  static double weakest(const std::vector<Scores::Entry>& integral, size_t positions, size_t position,
                        int first_chunk, int last_chunk, double mean);
  LineEvidence line(const Scores& scores, int position, int first_chunk, int last_chunk) const;

  FaceGrid grid_;
  std::array<Sums, kChannels> sums_;
  std::array<double, kChannels> variance_{};
  std::vector<uint8_t> face_;  ///< 0 unknown, 1 face, 2 no face
  Scores upright_, level_;
};

}  // namespace loci::mapping

#pragma once

#include <string>
#include <vector>

#include "perception/pipeline/annotator.h"

namespace loci::perception {

/// A box along the axes of a frame, or a sphere, in which somebody says that there is an object.
struct AssertedVolume {
  std::string frame;            ///< the scene's map frame, or the name of a support
  std::vector<double> numbers;  ///< x y z radius, or x y z and three extents; metres

  /// From "table_1 0.2 0.1 0.05 0.1"; Error when it is neither.
  static AssertedVolume parse(const std::string& text);
};

/// Volumes asserted from outside (by a person, another program, a plan) as object hypotheses. What they hold
/// above supports becomes a cluster; a cluster that is there already and overlaps with it takes the volume as
/// a further hypothesis of its own, so that one object stays one.
class AssertedVolumes : public Annotator {
 public:
  static constexpr const char* kName = "AssertedVolumes";
  AnnotatorDescriptor descriptor() const override;
  void declare(OptionTable& table) override;
  /// Error when a volume cannot be read.
  void start(Context& context) override;
  void process(cas::Cas& cas, Context& context) override;

 private:
  std::vector<std::string> texts_;
  double above_m_ = 0.01;
  double overlap_ = 0.5;
  int min_points_ = 30;
  std::vector<AssertedVolume> volumes_;
};

}  // namespace loci::perception

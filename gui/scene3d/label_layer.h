#pragma once

#include <vtkBillboardTextActor3D.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>

#include <string>
#include <vector>

#include "gui/scene3d/scene_colors.h"
#include "mapping/base/pose.h"

namespace loci {

/// Names beside things. Where labels would cover each other, the less important one is left out.
class LabelLayer {
 public:
  explicit LabelLayer(vtkRenderer* renderer) : renderer_(renderer) {}

  struct Label {
    std::string text;
    Vector3d anchor = Vector3d::Zero();  ///< map frame; the text stands above it
    double importance = 0;               ///< higher wins
    bool emphasised = false;
  };

  /// The most important few hundred.
  void set(std::vector<Label> labels, const SceneColors& colors);
  void set_visible(bool visible);
  /// Decides for the present camera and window size which labels are shown.
  void lay_out();
  /// Texts that are shown after the last lay_out().
  std::vector<std::string> shown() const;

 private:
  struct Item {
    Label label;
    vtkSmartPointer<vtkBillboardTextActor3D> actor;
    int width = 0, height = 0;  ///< pixels
  };
  Item make(Label label);

  vtkRenderer* renderer_;
  std::vector<Item> items_;  ///< the most important first
  SceneColors colors_;
  bool visible_ = true;
};

}  // namespace loci

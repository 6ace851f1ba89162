#pragma once

#include <vtkRenderer.h>
#include <vtkSmartPointer.h>
#include <vtkTexture.h>
#include <vtkTexturedActor2D.h>

#include <string>
#include <vector>

#include "gui/scene3d/label_atlas.h"
#include "gui/scene3d/scene_colors.h"
#include "mapping/base/pose.h"

namespace loci::gui {

/// Names beside things. Where labels would cover each other, the less important one is left out. All of them
/// are one actor.
class LabelLayer {
 public:
  explicit LabelLayer(vtkRenderer* renderer);

  struct Label {
    std::string text;
    Vector3d anchor = Vector3d::Zero();  ///< map frame; the text stands above it
    double importance = 0;               ///< higher wins
    bool emphasised = false;
  };

  /// The most important few hundred.
  void set(std::vector<Label> labels, const SceneColors& colors);
  void set_visible(bool visible);
  /// Decides for the present camera and window size which labels are shown, and where.
  void lay_out();
  /// Texts that are shown after the last lay_out().
  std::vector<std::string> shown() const;

 private:
  struct Item {
    Label label;
    LabelAtlas::Area area;
    bool shown = false;
    int left = 0, bottom = 0;  ///< pixels of the window
  };
  void draw();

  vtkRenderer* renderer_;
  vtkSmartPointer<vtkTexturedActor2D> actor_;
  vtkSmartPointer<vtkTexture> texture_;
  LabelAtlas atlas_;
  std::vector<Item> items_;  ///< the most important first
  bool visible_ = true;
};

}  // namespace loci::gui

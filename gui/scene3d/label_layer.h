#pragma once

#include <vtkImageData.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>
#include <vtkTexture.h>
#include <vtkTexturedActor2D.h>
#include <array>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "gui/scene3d/scene_colors.h"
#include "mapping/base/math/pose.h"

namespace loci::gui {

/// Texts drawn once, side by side, into one image: hundreds of labels then cost one texture.
class LabelAtlas {
 public:
  /// Where a text stands in the image, pixels from its lower left corner.
  struct Area {
    int left = 0, bottom = 0, width = 0, height = 0;
  };

  /// Forgets all texts when the colours differ.
  void set_colors(const SceneColors& colors);
  /// The text's place, drawn when it is new. Areas hold until set_colors() or trim().
  Area area(const std::string& text, bool emphasised);
  /// Forgets all texts when there are so many that the image has become large.
  void trim();

  /// RGBA, of a fixed width.
  vtkImageData* image();
  int width() const;
  int height() const { return height_; }

 private:
  using Key = std::pair<std::string, bool>;
  void forget();
  void grow(int height);

  SceneColors colors_;
  std::map<Key, Area> areas_;
  vtkSmartPointer<vtkImageData> image_ = vtkSmartPointer<vtkImageData>::New();
  int height_ = 0, used_height_ = 0;   ///< of the image; of its full rows
  int row_left_ = 0, row_bottom_ = 0;  ///< where the next text goes
};

/// Names beside objects, with a line to each. Where labels would cover each other, the less important one is
/// left out. All of them are one actor.
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
    int x = 0, y = 0;          ///< where the anchor is
  };
  void draw();
  void draw_leaders();

  vtkRenderer* renderer_;
  vtkSmartPointer<vtkTexturedActor2D> actor_;
  vtkSmartPointer<vtkActor2D> leaders_;  ///< lines from the labels to their anchors
  vtkSmartPointer<vtkTexture> texture_;
  LabelAtlas atlas_;
  std::vector<Item> items_;  ///< the most important first
  bool visible_ = true;
};

}  // namespace loci::gui

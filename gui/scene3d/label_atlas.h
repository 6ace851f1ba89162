#pragma once

#include <vtkImageData.h>
#include <vtkSmartPointer.h>

#include <array>
#include <map>
#include <string>
#include <utility>

#include "gui/scene3d/scene_colors.h"

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

}  // namespace loci::gui

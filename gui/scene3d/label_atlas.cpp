#include "gui/scene3d/label_atlas.h"

#include <vtkNew.h>
#include <vtkStdString.h>
#include <vtkTextProperty.h>
#include <vtkTextRenderer.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace loci::gui {
namespace {

constexpr int kFontSize = 13;
constexpr int kScreenDpi = 72;
constexpr int kWidth = 1024;
constexpr int kFirstHeight = 128, kMaxHeight = 2048;
constexpr int kChannels = 4;

vtkSmartPointer<vtkTextProperty> style_of(bool emphasised, const SceneColors& colors) {
  auto text = vtkSmartPointer<vtkTextProperty>::New();
  text->SetFontFamilyToArial();
  text->SetFontSize(static_cast<int>(std::lround(kFontSize * colors.pixels)));
  text->SetBold(emphasised);
  const SceneColor& front = emphasised ? colors.label_back : colors.label_text;
  const SceneColor& back = emphasised ? colors.accent : colors.label_back;
  text->SetColor(front[0], front[1], front[2]);
  text->SetBackgroundColor(back[0], back[1], back[2]);
  text->SetBackgroundOpacity(emphasised ? 0.95 : 0.8);
  return text;
}

unsigned char* pixel(vtkImageData& image, int x, int y) {
  return static_cast<unsigned char*>(image.GetScalarPointer(x, y, 0));
}

void make_clear(vtkImageData& image, int height) {
  image.SetDimensions(kWidth, height, 1);
  image.AllocateScalars(VTK_UNSIGNED_CHAR, kChannels);
  std::memset(image.GetScalarPointer(), 0,
              static_cast<size_t>(kWidth) * static_cast<size_t>(height) * kChannels);
}

}  // namespace

void LabelAtlas::set_colors(const SceneColors& colors) {
  if (colors.label_text == colors_.label_text && colors.label_back == colors_.label_back &&
      colors.accent == colors_.accent && colors.pixels == colors_.pixels && height_ > 0)
    return;
  colors_ = colors;
  forget();
}

void LabelAtlas::forget() {
  areas_.clear();
  row_left_ = row_bottom_ = used_height_ = 0;
  height_ = kFirstHeight;
  make_clear(*image_, height_);
}

void LabelAtlas::trim() {
  if (height_ >= kMaxHeight) forget();
}

void LabelAtlas::grow(int height) {
  auto larger = vtkSmartPointer<vtkImageData>::New();
  make_clear(*larger, height);
  std::memcpy(larger->GetScalarPointer(), image_->GetScalarPointer(),
              static_cast<size_t>(kWidth) * static_cast<size_t>(height_) * kChannels);
  image_ = larger;
  height_ = height;
}

LabelAtlas::Area LabelAtlas::area(const std::string& text, bool emphasised) {
  if (height_ == 0) forget();
  const auto known = areas_.find({text, emphasised});
  if (known != areas_.end()) return known->second;
  Area area;
  vtkNew<vtkImageData> drawn;
  std::array<int, 2> size = {0, 0};
  auto* renderer = vtkTextRenderer::GetInstance();
  // Spaces are the padding of the background.
  if (renderer != nullptr &&
      renderer->RenderString(style_of(emphasised, colors_), vtkStdString(" " + text + " "), drawn,
                             size.data(), kScreenDpi)) {
    const int* extent = drawn->GetExtent();
    area.width = std::min({size[0], extent[1] - extent[0] + 1, kWidth});
    area.height = std::min(size[1], extent[3] - extent[2] + 1);
    if (row_left_ + area.width > kWidth) {
      row_left_ = 0;
      row_bottom_ = used_height_;
    }
    while (row_bottom_ + area.height > height_) grow(2 * height_);
    area.left = row_left_;
    area.bottom = row_bottom_;
    for (int y = 0; y < area.height; ++y)
      std::memcpy(pixel(*image_, area.left, area.bottom + y), pixel(*drawn, extent[0], extent[2] + y),
                  static_cast<size_t>(area.width) * kChannels);
    image_->Modified();
    row_left_ += area.width;
    used_height_ = std::max(used_height_, area.bottom + area.height);
  }
  areas_.emplace(std::pair(text, emphasised), area);
  return area;
}

vtkImageData* LabelAtlas::image() {
  return image_;
}

int LabelAtlas::width() const {
  return kWidth;
}

}  // namespace loci::gui

#include "gui/scene3d/label_layer.h"

#include <vtkActor2D.h>
#include <vtkCamera.h>
#include <vtkCellArray.h>
#include <vtkFloatArray.h>
#include <vtkMatrix4x4.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper2D.h>
#include <vtkProperty2D.h>
#include <vtkRenderWindow.h>
#include <vtkStdString.h>
#include <vtkTextProperty.h>
#include <vtkTextRenderer.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <optional>
#include <utility>

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

namespace {

constexpr int kGap = 7;             // pixels between the anchor and the text
constexpr size_t kMaxLabels = 300;  // more would cover each other

struct Rectangle {
  int left, bottom, right, top;
  bool overlaps(const Rectangle& other) const {
    return left < other.right && other.left < right && bottom < other.top && other.bottom < top;
  }
};

/// Map frame to pixels of a window.
class Projection {
 public:
  Projection(vtkRenderer& renderer, int width, int height) : width_(width), height_(height) {
    const auto* matrix = renderer.GetActiveCamera()->GetCompositeProjectionTransformMatrix(
        static_cast<double>(width) / std::max(1, height), -1, 1);
    for (int row = 0; row < 4; ++row)
      for (int column = 0; column < 4; ++column) matrix_(row, column) = matrix->GetElement(row, column);
  }
  /// Unset behind the eye.
  std::optional<Vector2d> pixel(const Vector3d& point) const {
    const Eigen::Vector4d clip = matrix_ * point.homogeneous();
    if (clip.w() <= 0) return std::nullopt;
    return Vector2d((clip.x() / clip.w() + 1) / 2 * width_, (clip.y() / clip.w() + 1) / 2 * height_);
  }

 private:
  int width_, height_;
  Eigen::Matrix4d matrix_;
};

}  // namespace

LabelLayer::LabelLayer(vtkRenderer* renderer)
    : renderer_(renderer),
      actor_(vtkSmartPointer<vtkTexturedActor2D>::New()),
      leaders_(vtkSmartPointer<vtkActor2D>::New()),
      texture_(vtkSmartPointer<vtkTexture>::New()) {
  vtkNew<vtkPolyDataMapper2D> lines;
  lines->SetInputData(vtkNew<vtkPolyData>());
  leaders_->SetMapper(lines);
  leaders_->PickableOff();
  renderer_->AddActor2D(leaders_);
  vtkNew<vtkPolyDataMapper2D> mapper;
  mapper->SetInputData(vtkNew<vtkPolyData>());
  actor_->SetMapper(mapper);
  actor_->PickableOff();
  texture_->InterpolateOff();  // a pixel of the image is one of the window
  texture_->RepeatOff();
  actor_->SetTexture(texture_);
  renderer_->AddActor2D(actor_);
}

void LabelLayer::set(std::vector<Label> labels, const SceneColors& colors) {
  std::stable_sort(labels.begin(), labels.end(),
                   [](const Label& a, const Label& b) { return a.importance > b.importance; });
  if (labels.size() > kMaxLabels) labels.resize(kMaxLabels);
  atlas_.set_colors(colors);
  atlas_.trim();
  leaders_->GetProperty()->SetColor(colors.label_text[0], colors.label_text[1], colors.label_text[2]);
  leaders_->GetProperty()->SetLineWidth(static_cast<float>(colors.pixels));
  items_.clear();
  for (Label& label : labels) {
    Item item;
    item.label = std::move(label);
    items_.push_back(std::move(item));
  }
}

void LabelLayer::set_visible(bool visible) {
  visible_ = visible;
}

void LabelLayer::lay_out() {
  const int* size = renderer_->GetRenderWindow()->GetSize();
  const Projection projection(*renderer_, size[0], size[1]);
  std::vector<Rectangle> taken;
  for (Item& item : items_) {
    item.shown = false;
    const auto at = visible_ ? projection.pixel(item.label.anchor) : std::nullopt;
    if (!at || at->x() < 0 || at->y() < 0 || at->x() > size[0] || at->y() > size[1]) continue;
    item.area = atlas_.area(item.label.text, item.label.emphasised);
    if (item.area.width == 0) continue;
    const int x = static_cast<int>(std::lround(at->x())), y = static_cast<int>(std::lround(at->y()));
    const int width = item.area.width, height = item.area.height;
    // Above the anchor; where that is taken, beside it; else no label.
    for (const auto& [wanted_left, wanted_bottom] :
         {std::pair(x - width / 2, y + kGap), std::pair(x + kGap, y - height),
          std::pair(x - kGap - width, y - height)}) {
      // Nothing is cut off at the window's sides.
      const int left = std::clamp(wanted_left, 0, std::max(0, size[0] - width));
      const int bottom = std::clamp(wanted_bottom, 0, std::max(0, size[1] - height));
      const Rectangle place = {left, bottom, left + width, bottom + height};
      if (std::any_of(taken.begin(), taken.end(),
                      [&](const Rectangle& other) { return place.overlaps(other); }))
        continue;
      item.shown = true;
      item.left = left;
      item.bottom = bottom;
      item.x = x;
      item.y = y;
      taken.push_back(place);
      break;
    }
  }
  draw();
}

void LabelLayer::draw() {
  vtkNew<vtkPoints> points;
  vtkNew<vtkFloatArray> in_atlas;
  in_atlas->SetNumberOfComponents(2);
  vtkNew<vtkCellArray> quads;
  const auto add_corner = [&](const Item& item, int x, int y) {
    points->InsertNextPoint(item.left + x, item.bottom + y, 0);
    in_atlas->InsertNextTuple2(static_cast<double>(item.area.left + x) / atlas_.width(),
                               static_cast<double>(item.area.bottom + y) / atlas_.height());
  };
  for (const Item& item : items_) {
    if (!item.shown) continue;
    const vtkIdType first = points->GetNumberOfPoints();
    add_corner(item, 0, 0);
    add_corner(item, item.area.width, 0);
    add_corner(item, item.area.width, item.area.height);
    add_corner(item, 0, item.area.height);
    const std::array<vtkIdType, 4> corners = {first, first + 1, first + 2, first + 3};
    quads->InsertNextCell(4, corners.data());
  }
  actor_->SetVisibility(points->GetNumberOfPoints() > 0);
  vtkNew<vtkPolyData> data;
  data->SetPoints(points);
  data->SetPolys(quads);
  data->GetPointData()->SetTCoords(in_atlas);
  static_cast<vtkPolyDataMapper2D*>(actor_->GetMapper())->SetInputData(data);
  texture_->SetInputData(atlas_.image());
  draw_leaders();
}

/// From the nearest point of a label's border to its anchor.
void LabelLayer::draw_leaders() {
  vtkNew<vtkPoints> points;
  vtkNew<vtkCellArray> lines;
  for (const Item& item : items_) {
    if (!item.shown) continue;
    const int x = std::clamp(item.x, item.left, item.left + item.area.width);
    const int y = std::clamp(item.y, item.bottom, item.bottom + item.area.height);
    const std::array<vtkIdType, 2> ends = {points->InsertNextPoint(x, y, 0),
                                           points->InsertNextPoint(item.x, item.y, 0)};
    lines->InsertNextCell(2, ends.data());
  }
  leaders_->SetVisibility(points->GetNumberOfPoints() > 0);
  vtkNew<vtkPolyData> data;
  data->SetPoints(points);
  data->SetLines(lines);
  static_cast<vtkPolyDataMapper2D*>(leaders_->GetMapper())->SetInputData(data);
}

std::vector<std::string> LabelLayer::shown() const {
  std::vector<std::string> texts;
  for (const Item& item : items_)
    if (item.shown) texts.push_back(item.label.text);
  return texts;
}

}  // namespace loci::gui

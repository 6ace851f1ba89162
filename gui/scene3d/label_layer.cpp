#include "gui/scene3d/label_layer.h"

#include <vtkCoordinate.h>
#include <vtkNew.h>
#include <vtkStdString.h>
#include <vtkTextProperty.h>
#include <vtkTextRenderer.h>

#include <algorithm>
#include <array>
#include <map>
#include <utility>

namespace loci {
namespace {

constexpr int kFontSize = 13;
constexpr int kGap = 7;  // pixels between the anchor and the text
constexpr int kScreenDpi = 72;
constexpr size_t kMostLabels = 300;  // more would cover each other

struct Rectangle {
  double left, bottom, right, top;
  bool overlaps(const Rectangle& other) const {
    return left < other.right && other.left < right && bottom < other.top && other.bottom < top;
  }
};

vtkSmartPointer<vtkBillboardTextActor3D> actor_of(const LabelLayer::Label& label, const SceneColors& colors) {
  auto actor = vtkSmartPointer<vtkBillboardTextActor3D>::New();
  // Spaces are the padding of the background.
  actor->SetInput((" " + label.text + " ").c_str());
  actor->SetPosition(label.anchor.x(), label.anchor.y(), label.anchor.z());
  actor->SetDisplayOffset(0, kGap);
  actor->PickableOff();
  vtkTextProperty* text = actor->GetTextProperty();
  text->SetFontFamilyToArial();
  text->SetFontSize(kFontSize);
  text->SetBold(label.emphasised);
  text->SetJustificationToCentered();
  text->SetVerticalJustificationToBottom();
  text->SetColor(label.emphasised ? colors.label_back[0] : colors.label_text[0],
                 label.emphasised ? colors.label_back[1] : colors.label_text[1],
                 label.emphasised ? colors.label_back[2] : colors.label_text[2]);
  const SceneColor& back = label.emphasised ? colors.accent : colors.label_back;
  text->SetBackgroundColor(back[0], back[1], back[2]);
  text->SetBackgroundOpacity(label.emphasised ? 0.95 : 0.72);
  return actor;
}

}  // namespace

void LabelLayer::set(std::vector<Label> labels, const SceneColors& colors) {
  std::stable_sort(labels.begin(), labels.end(),
                   [](const Label& a, const Label& b) { return a.importance > b.importance; });
  if (labels.size() > kMostLabels) labels.resize(kMostLabels);
  // A text is drawn into a texture: what says the same as before keeps it.
  std::multimap<std::pair<std::string, bool>, Item> before;
  const bool same_colors = colors.label_text == colors_.label_text &&
                           colors.label_back == colors_.label_back && colors.accent == colors_.accent;
  for (Item& item : items_)
    if (same_colors)
      before.emplace(std::pair(item.label.text, item.label.emphasised), std::move(item));
    else
      renderer_->RemoveActor(item.actor);
  items_.clear();
  colors_ = colors;
  for (Label& label : labels) {
    const auto known = before.find({label.text, label.emphasised});
    if (known == before.end()) {
      items_.push_back(make(std::move(label)));
      continue;
    }
    items_.push_back(std::move(known->second));
    before.erase(known);
    items_.back().label = std::move(label);
    const Vector3d& anchor = items_.back().label.anchor;
    items_.back().actor->SetPosition(anchor.x(), anchor.y(), anchor.z());
  }
  for (const auto& [key, item] : before) renderer_->RemoveActor(item.actor);
}

LabelLayer::Item LabelLayer::make(Label label) {
  Item item;
  item.label = std::move(label);
  item.actor = actor_of(item.label, colors_);
  std::array<int, 4> box = {0, 0, 0, 0};
  if (auto* measure = vtkTextRenderer::GetInstance())
    measure->GetBoundingBox(item.actor->GetTextProperty(), vtkStdString(item.actor->GetInput()), box.data(),
                            kScreenDpi);
  item.width = box[1] - box[0] + 1;
  item.height = box[3] - box[2] + 1;
  renderer_->AddActor(item.actor);
  return item;
}

void LabelLayer::set_visible(bool visible) {
  visible_ = visible;
}

void LabelLayer::lay_out() {
  std::vector<Rectangle> taken;
  vtkNew<vtkCoordinate> coordinate;
  coordinate->SetCoordinateSystemToWorld();
  for (Item& item : items_) {
    item.actor->SetVisibility(false);
    if (!visible_) continue;
    coordinate->SetValue(item.label.anchor.x(), item.label.anchor.y(), item.label.anchor.z());
    const double* at = coordinate->GetComputedDoubleDisplayValue(renderer_);
    const int aside = item.width / 2 + kGap;
    // Above the thing; where that is taken, beside it; else it goes without a name.
    for (const auto& [dx, dy] :
         {std::pair(0, kGap), std::pair(aside, -item.height), std::pair(-aside, -item.height)}) {
      const Rectangle place = {at[0] + dx - item.width / 2.0, at[1] + dy, at[0] + dx + item.width / 2.0,
                               at[1] + dy + item.height};
      if (std::any_of(taken.begin(), taken.end(),
                      [&](const Rectangle& other) { return place.overlaps(other); }))
        continue;
      item.actor->SetDisplayOffset(dx, dy);
      item.actor->SetVisibility(true);
      taken.push_back(place);
      break;
    }
  }
}

std::vector<std::string> LabelLayer::shown() const {
  std::vector<std::string> texts;
  for (const Item& item : items_)
    if (item.actor->GetVisibility() != 0) texts.push_back(item.label.text);
  return texts;
}

}  // namespace loci

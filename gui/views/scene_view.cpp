#include "gui/views/scene_view.h"

#include <QHeaderView>
#include <QTreeWidget>
#include <QVBoxLayout>
#include <map>

#include "gui/views/scene_image.h"

namespace loci::gui {
namespace {
constexpr int kRowsShown = 5;
constexpr int kNoteRole = Qt::UserRole;
}  // namespace

SceneView::SceneView(Browser& browser, QWidget* parent)
    : QWidget(parent),
      browser_(browser),
      image_(new SceneImage(browser, this)),
      tree_(new QTreeWidget(this)) {
  tree_->setHeaderLabels({"Found in the image", "By"});
  tree_->header()->setStretchLastSection(false);
  tree_->header()->setSectionResizeMode(0, QHeaderView::Stretch);
  tree_->header()->setSectionResizeMode(1, QHeaderView::ResizeToContents);
  tree_->setMaximumHeight((fontMetrics().height() + 6) * (kRowsShown + 1));
  tree_->hide();
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->setSpacing(2);
  layout->addWidget(image_, 1);
  layout->addWidget(tree_);
  connect(&browser_, &Browser::opened, this, [this] { scene_ = 0; });
  connect(&browser_, &Browser::belief_changed, this, &SceneView::refresh);
  connect(tree_, &QTreeWidget::currentItemChanged, this, [this](const QTreeWidgetItem* item) {
    const QVariant number = item == nullptr ? QVariant() : item->data(0, kNoteRole);
    image_->mark(number.isValid() ? std::optional<size_t>(number.toULongLong()) : std::nullopt);
  });
  refresh();
}

void SceneView::refresh() {
  const auto& content = browser_.moment().content;
  const int64_t scene = content == nullptr ? 0 : content->scene.id;
  if (scene == scene_ && scene != 0) return;
  scene_ = scene;
  if (!notes_.empty() || scene == 0) show_notes({});
  if (scene == 0) return;
  browser_.reader().read<std::vector<ImageNote>>(
      this, "notes", Urgency::rest, [scene](const BrowserData& memory) { return memory.notes(scene); },
      [this, scene](std::vector<ImageNote>& notes) {
        if (scene == scene_ && !notes.empty()) show_notes(std::move(notes));
      });
}

/// A group per kind, with what was found below it.
void SceneView::show_notes(std::vector<ImageNote> notes) {
  notes_ = std::move(notes);
  tree_->clear();
  std::map<std::string, QTreeWidgetItem*> groups;
  for (size_t i = 0; i < notes_.size(); ++i) {
    const ImageNote& note = notes_[i];
    QTreeWidgetItem*& group = groups[note.type];
    if (group == nullptr) {
      group = new QTreeWidgetItem(tree_, {QString::fromStdString(note.type).remove("Annotation")});
      group->setFirstColumnSpanned(true);
    }
    const QString text = note.text.empty() ? QString("–") : QString::fromStdString(note.text);
    auto* item = new QTreeWidgetItem(group, {text, QString::fromStdString(note.expert)});
    item->setToolTip(0, text);
    item->setData(0, kNoteRole, static_cast<qulonglong>(i));
  }
  tree_->expandAll();
  tree_->setVisible(!notes_.empty());
  image_->set_notes(notes_);
}

}  // namespace loci::gui

#include "gui/views/scene_view.h"

#include <QHeaderView>
#include <QMouseEvent>
#include <QPainter>
#include <QTreeWidget>
#include <QVBoxLayout>
#include <algorithm>
#include <cmath>
#include <map>

#include "gui/core/text.h"
#include "gui/core/theme.h"
#include "gui/data/scene_content.h"

namespace loci::gui {
namespace {

/// The nearest and the farthest measurement, metres; 0 without any.
std::pair<float, float> depth_range(const cv::Mat& depth) {
  float near = 0;
  float far = 0;
  for (int y = 0; y < depth.rows; ++y)
    for (int x = 0; x < depth.cols; ++x) {
      const float z = depth.at<float>(y, x);
      if (!std::isfinite(z) || z <= 0) continue;
      near = near == 0 ? z : std::min(near, z);
      far = std::max(far, z);
    }
  return {near, far};
}

/// Near is warm, far is cold; `part` is 0 for the nearest and 1 for the farthest.
QColor depth_color(double part) {
  return QColor::fromHsvF(0.66 * part, 0.75, 1.0 - 0.35 * part);
}

/// No measurement is black.
QImage depth_image(const cv::Mat& depth) {
  if (depth.empty()) return {};
  const auto [near, far] = depth_range(depth);
  const float span = std::max(far - near, 1e-3F);
  QImage image(depth.cols, depth.rows, QImage::Format_RGB32);
  for (int y = 0; y < depth.rows; ++y)
    for (int x = 0; x < depth.cols; ++x) {
      const float z = depth.at<float>(y, x);
      const bool valid = std::isfinite(z) && z > 0;
      const double part = valid ? static_cast<double>((z - near) / span) : 0;
      image.setPixelColor(x, y, valid ? depth_color(part) : Qt::black);
    }
  return image;
}

QColor color_of(mapping::PixelKind kind) {
  switch (kind) {
    case mapping::PixelKind::map_explained:
      return {40, 110, 230, 110};
    case mapping::PixelKind::background:
      return {0, 0, 0, 150};
    case mapping::PixelKind::region_of_interest:
      return {60, 200, 80, 110};
    case mapping::PixelKind::unmeasured:
      break;
  }
  return {0, 0, 0, 0};
}

QImage kinds_image(const cv::Mat& kinds) {
  if (kinds.empty()) return {};
  QImage image(kinds.cols, kinds.rows, QImage::Format_ARGB32);
  for (int y = 0; y < kinds.rows; ++y)
    for (int x = 0; x < kinds.cols; ++x)
      image.setPixelColor(x, y, color_of(static_cast<mapping::PixelKind>(kinds.at<uint8_t>(y, x))));
  return image;
}

}  // namespace

SceneImage::SceneImage(Browser& browser, QWidget* parent) : QWidget(parent), browser_(browser) {
  setMinimumSize(200, 104);
  setMouseTracking(true);
  connect(&browser_, &Browser::belief_changed, this, &SceneImage::refresh);
  connect(&browser_, &Browser::selected, this, [this] { update(); });
  refresh();
}

void SceneImage::show_depth(bool depth) {
  depth_ = depth;
  remake_image();
}

void SceneImage::refresh() {
  const auto& content = browser_.moment().content;
  if (content == content_) return update();
  content_ = content;
  remake_image();
}

void SceneImage::remake_image() {
  image_ = {};
  if (content_) image_ = depth_ ? depth_image(content_->depth) : image_of(content_->color);
  kinds_ = {};
  if (content_ && shows_kinds_) kinds_ = kinds_image(depth_ ? content_->kinds : kinds_in_color(*content_));
  update();
}

void SceneImage::show_masks(bool masks) {
  masks_ = masks;
  update();
}

void SceneImage::show_kinds(bool kinds) {
  shows_kinds_ = kinds;
  remake_image();
}

int SceneImage::legend_height() const {
  return QFontMetrics(small_font(font())).height() + 4;
}

QRectF SceneImage::image_area() const {
  const QRectF room =
      rect().adjusted(0, shows_kinds_ ? legend_height() : 0, 0, depth_ ? -legend_height() : 0);
  const QSizeF size = QSizeF(image_.size()).scaled(room.size(), Qt::KeepAspectRatio);
  return {room.center() - QPointF(size.width(), size.height()) / 2, size};
}

QRectF SceneImage::on_widget(const ImageBox& box) const {
  const cv::Rect2d& pixels = depth_ ? box.depth : box.color;
  const mapping::PinholeCamera& camera = depth_ ? content_->camera.depth : content_->camera.color;
  if (pixels.empty() || camera.width <= 0 || image_.isNull()) return {};
  const QRectF area = image_area();
  const double sx = area.width() / camera.width;
  const double sy = area.height() / camera.height;
  return QRectF(area.left() + pixels.x * sx, area.top() + pixels.y * sy, pixels.width * sx,
                pixels.height * sy)
      .intersected(area);
}

const std::vector<ImageBox>& SceneImage::boxes() const {
  static const std::vector<ImageBox> kNone;
  return content_ ? content_->boxes : kNone;
}

std::optional<QRectF> SceneImage::box_of(int64_t object) const {
  for (const ImageBox& box : boxes())
    if (box.object == object && !on_widget(box).isEmpty()) return on_widget(box);
  return std::nullopt;
}

const ImageBox* SceneImage::box_at(const QPointF& point) const {
  const ImageBox* best = nullptr;  // the smallest, where they overlap
  double least = 0;
  for (const ImageBox& box : boxes()) {
    const QRectF area = on_widget(box);
    if (!area.contains(point)) continue;
    const double size = area.width() * area.height();
    if (best == nullptr || size < least) {
      best = &box;
      least = size;
    }
  }
  return best;
}

QString SceneImage::empty_text() const {
  if (browser_.data() == nullptr) return "The image of the selected scene";
  if (browser_.scene() == nullptr) return "This memory has no scenes";
  return depth_ ? "No depth is stored for this scene" : "No image is stored for this scene";
}

void SceneImage::paintEvent(QPaintEvent*) {
  QPainter painter(this);
  const Theme theme = Theme::of(palette());
  painter.fillRect(rect(), theme.dark ? QColor(20, 21, 23) : QColor(226, 228, 232));
  if (image_.isNull()) {
    painter.setPen(theme.muted);
    painter.drawText(rect(), Qt::AlignCenter | Qt::TextWordWrap, empty_text());
    return;
  }
  painter.setRenderHint(QPainter::SmoothPixmapTransform);
  painter.drawImage(image_area(), image_);
  painter.setRenderHint(QPainter::Antialiasing);
  if (!kinds_.isNull()) painter.drawImage(image_area(), kinds_);
  const auto selected = browser_.selection().object();
  for (const ImageBox& box : boxes())
    if (box.object != selected) paint_box(painter, box);
  for (const ImageBox& box : boxes())
    if (box.object == selected) paint_box(painter, box);
  paint_notes(painter);
  paint_names(painter);
  if (shows_kinds_) paint_kinds(painter);
  if (depth_) paint_depth_scale(painter);
  paint_values(painter);
}

void SceneImage::paint_values(QPainter& painter) const {
  const QString text =
      values_.isEmpty() ? apart_text(content_->scene.time, browser_.selection().time()) : values_;
  if (text.isEmpty()) return;
  painter.setFont(small_font(font()));
  const QSizeF size = painter.fontMetrics().size(Qt::TextSingleLine, text) + QSize(10, 4);
  const QRectF area(QPointF(0, height() - size.height()), size);
  painter.fillRect(area, QColor(0, 0, 0, 190));
  painter.setPen(Qt::white);
  painter.drawText(area, Qt::AlignCenter, text);
}

/// What the colours of the depth image mean, below it.
void SceneImage::paint_depth_scale(QPainter& painter) const {
  const auto [near, far] = depth_range(content_->depth);
  painter.setFont(small_font(font()));
  const QFontMetrics metrics = painter.fontMetrics();
  const auto text = [](float z) { return QString("%1 m").arg(static_cast<double>(z), 0, 'f', 2); };
  const int top = height() - legend_height(), margin = metrics.horizontalAdvance(text(far)) + 14;
  const QRectF bar(margin, top + 4, width() - 2 * margin, legend_height() - 8);
  QLinearGradient colors(bar.topLeft(), bar.topRight());
  for (const double part : {0.0, 0.25, 0.5, 0.75, 1.0}) colors.setColorAt(part, depth_color(part));
  painter.fillRect(bar, colors);
  painter.setPen(Theme::of(palette()).text);
  const QRect line(6, top, width() - 12, legend_height());
  painter.drawText(line, Qt::AlignVCenter | Qt::AlignLeft, text(near));
  painter.drawText(line, Qt::AlignVCenter | Qt::AlignRight, text(far));
}

/// What the tints mean, above the image.
void SceneImage::paint_kinds(QPainter& painter) const {
  std::vector<std::pair<mapping::PixelKind, QString>> kinds;
  for (int i = 1; i < mapping::kPixelKinds; ++i) {
    const auto kind = static_cast<mapping::PixelKind>(i);
    kinds.emplace_back(kind, QString::fromUtf8(to_text(kind).data()));
  }
  painter.setFont(small_font(font()));
  const QFontMetrics metrics = painter.fontMetrics();
  const int side = metrics.ascent(), height = legend_height();
  if (kinds_.isNull()) {
    painter.fillRect(0, 0, width(), height, QColor(0, 0, 0, 190));
    painter.setPen(Qt::white);
    return painter.drawText(
        QRect(0, 0, width(), height), Qt::AlignCenter,
        metrics.elidedText("No pixel kinds are stored for this scene", Qt::ElideRight, width()));
  }
  int x = 6;
  int end = x;
  for (const auto& [kind, name] : kinds) end += side + 12 + metrics.horizontalAdvance(name);
  painter.fillRect(0, 0, end, height, QColor(0, 0, 0, 190));
  for (const auto& [kind, name] : kinds) {
    const QRect square(x, (height - side) / 2, side, side);
    painter.fillRect(square, QColor(190, 190, 190));  // tinted as a grey part of the image is
    painter.fillRect(square, color_of(kind));
    painter.setPen(QColor(140, 140, 140));
    painter.setBrush(Qt::NoBrush);
    painter.drawRect(square);
    painter.setPen(Qt::white);
    painter.drawText(QRect(x + side + 4, 0, width(), height), Qt::AlignVCenter, name);
    x += side + 12 + metrics.horizontalAdvance(name);
  }
}

/// The outline of an object, lightly filled for the selected one.
void SceneImage::paint_mask(QPainter& painter, const ImageBox& box) const {
  const mapping::PinholeCamera& camera = depth_ ? content_->camera.depth : content_->camera.color;
  if (!masks_ || camera.width <= 0) return;
  const Theme theme = Theme::of(palette());
  const bool selected = browser_.selection().object() == box.object && box.object != 0;
  const QRectF area = image_area();
  QColor fill = selected ? theme.accent : QColor(Qt::white);
  fill.setAlpha(selected ? 90 : 40);
  painter.setBrush(fill);
  painter.setPen(QPen(selected ? theme.accent : QColor(255, 255, 255, 200), 1));
  for (const auto& outline : depth_ ? box.depth_outline : box.color_outline) {
    QPolygonF polygon;
    for (const cv::Point2f& pixel : outline)
      polygon << QPointF(area.left() + static_cast<double>(pixel.x + 0.5F) * area.width() / camera.width,
                         area.top() + static_cast<double>(pixel.y + 0.5F) * area.height() / camera.height);
    painter.drawPolygon(polygon);
  }
}

void SceneImage::paint_box(QPainter& painter, const ImageBox& box) const {
  const QRectF area = on_widget(box);
  if (area.isEmpty()) return;
  paint_mask(painter, box);
  const Theme theme = Theme::of(palette());
  const bool selected = browser_.selection().object() == box.object && box.object != 0;
  const QColor color = selected ? theme.accent : QColor(255, 255, 255, box.object == 0 ? 120 : 255);
  painter.setBrush(Qt::NoBrush);
  painter.setPen(QPen(QColor(0, 0, 0, box.object == 0 ? 60 : 140), selected ? 4.5 : 3));
  painter.drawRoundedRect(area, 2, 2);
  painter.setPen(QPen(color, selected ? 2.5 : 1.3));
  painter.drawRoundedRect(area, 2, 2);
}

QRectF SceneImage::on_widget(const ImageNote& note) const {
  if (depth_ || !content_ || content_->camera.color.width <= 0) return {};
  const QRectF area = image_area();
  const double sx = area.width() / content_->camera.color.width;
  const double sy = area.height() / content_->camera.color.height;
  return QRectF(area.left() + note.region.x * sx, area.top() + note.region.y * sy, note.region.width * sx,
                note.region.height * sy)
      .intersected(area);
}

void SceneImage::paint_notes(QPainter& painter) const {
  const Theme theme = Theme::of(palette());
  painter.setBrush(Qt::NoBrush);
  for (size_t i = 0; i < notes_.size(); ++i) {
    painter.setPen(
        QPen(marked_ == i ? theme.accent : QColor(255, 214, 90), marked_ == i ? 3 : 1.5, Qt::DashLine));
    painter.drawRect(on_widget(notes_[i]));
  }
}

void SceneImage::paint_names(QPainter& painter) const {
  const Theme theme = Theme::of(palette());
  const QRectF all = image_area();
  const auto selected = browser_.selection().object();
  std::vector<const ImageBox*> order;  // the selected one first: it gets the best place
  for (const ImageBox& box : boxes())
    if (!on_widget(box).isEmpty())
      order.insert(box.object == selected && box.object != 0 ? order.begin() : order.end(), &box);
  std::stable_partition(order.begin(), order.end(), [](const ImageBox* box) { return box->object != 0; });
  std::vector<QRectF> taken;
  for (const ImageBox* box : order) {
    const QRectF area = on_widget(*box);
    QFont font = small_font(this->font());
    font.setBold(box->object == selected);
    font.setItalic(box->object == 0);
    const QString name = QString::fromStdString(
        box->object == 0 ? box->unnamed : browser_.data()->names().object(box->object));
    const QSizeF size = QFontMetricsF(font).size(Qt::TextSingleLine, name) + QSizeF(8, 2);
    const double left = std::clamp(area.left(), all.left(), std::max(all.left(), all.right() - size.width()));
    // Above the box, below it, in it, or not at all.
    for (const double top : {area.top() - size.height() - 1, area.bottom() + 1, area.top() + 2}) {
      const QRectF label(QPointF(left, top), size);
      if (label.top() < all.top() || label.bottom() > all.bottom() ||
          std::any_of(taken.begin(), taken.end(),
                      [&](const QRectF& other) { return other.intersects(label); }))
        continue;
      taken.push_back(label);
      painter.setFont(font);
      painter.setPen(Qt::NoPen);
      painter.setBrush(box->object == selected ? theme.accent : QColor(0, 0, 0, 165));
      painter.drawRoundedRect(label, 3, 3);
      painter.setPen(Qt::white);
      painter.drawText(label, Qt::AlignCenter, name);
      break;
    }
  }
}

void SceneImage::set_notes(std::vector<ImageNote> notes) {
  notes_ = std::move(notes);
  marked_.reset();
  update();
}

void SceneImage::mark(std::optional<size_t> note) {
  marked_ = note;
  update();
}

QString SceneImage::values_at(const QPointF& point) const {
  const QRectF area = image_area();
  if (!content_ || image_.isNull() || !area.contains(point)) return {};
  const mapping::PinholeCamera& camera = depth_ ? content_->camera.depth : content_->camera.color;
  const Vector2d pixel((point.x() - area.left()) / area.width() * camera.width,
                       (point.y() - area.top()) / area.height() * camera.height);
  const PixelValues values = depth_ ? values_at_depth(*content_, pixel) : values_at_color(*content_, pixel);
  QStringList parts = {QString("%1, %2").arg(std::floor(pixel.x())).arg(std::floor(pixel.y()))};
  parts << (values.depth ? QString("%1 m").arg(*values.depth, 0, 'f', 3) : QString("no depth"));
  if (values.color)
    parts << QString("rgb %1 %2 %3").arg((*values.color)[0]).arg((*values.color)[1]).arg((*values.color)[2]);
  if (values.position)
    parts << QString("map %1, %2, %3")
                 .arg(values.position->x(), 0, 'f', 2)
                 .arg(values.position->y(), 0, 'f', 2)
                 .arg(values.position->z(), 0, 'f', 2);
  return parts.join(" · ");
}

void SceneImage::leaveEvent(QEvent*) {
  values_.clear();
  update();
}

void SceneImage::mousePressEvent(QMouseEvent* event) {
  const ImageBox* box = box_at(event->localPos());
  if (box != nullptr && box->object != 0)
    browser_.selection().select_object(box->object);
  else
    browser_.selection().clear();
}

void SceneImage::mouseMoveEvent(QMouseEvent* event) {
  const ImageBox* box = box_at(event->localPos());
  setCursor(box != nullptr ? Qt::PointingHandCursor : Qt::ArrowCursor);
  values_ = values_at(event->localPos());
  update();
}

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
      this, "notes", Urgency::rest, [scene](const OpenMemory& memory) { return memory.notes(scene); },
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
    auto* item = new QTreeWidgetItem(group, {text, QString::fromStdString(note.annotator)});
    item->setToolTip(0, text);
    item->setData(0, kNoteRole, static_cast<qulonglong>(i));
  }
  tree_->expandAll();
  tree_->setVisible(!notes_.empty());
  image_->set_notes(notes_);
}

}  // namespace loci::gui

#pragma once

#include <QImage>
#include <QWidget>
#include <optional>
#include <vector>

#include "gui/data/browser.h"
#include "gui/data/scene_content.h"

class QTreeWidget;

namespace loci::gui {

/// The image of the selected scene with the boxes of what was found in it; colour or depth. A click on a box
/// selects its object.
class SceneImage : public QWidget {
  Q_OBJECT

 public:
  explicit SceneImage(Browser& browser, QWidget* parent = nullptr);

  void show_depth(bool depth);
  /// Outlines of the objects.
  void show_masks(bool masks);
  /// Tints pixels by their mapping::PixelKind.
  void show_kinds(bool kinds);
  QSize sizeHint() const override { return {380, 285}; }
  /// Where an object's box is on the widget; unset when it is not in this image.
  std::optional<QRectF> box_of(int64_t object) const;
  /// What was found in parts of the image, drawn as dashed boxes; one of them may be marked.
  void set_notes(std::vector<ImageNote> notes);
  void mark(std::optional<size_t> note);
  /// What is measured at a point of the widget, as one line; empty outside the image.
  QString values_at(const QPointF& point) const;

 protected:
  void leaveEvent(QEvent* event) override;
  void paintEvent(QPaintEvent* event) override;
  void mousePressEvent(QMouseEvent* event) override;
  void mouseMoveEvent(QMouseEvent* event) override;

 private:
  void refresh();
  void remake_image();
  const std::vector<ImageBox>& boxes() const;
  QRectF image_area() const;
  QRectF on_widget(const ImageBox& box) const;
  const ImageBox* box_at(const QPointF& point) const;
  QRectF on_widget(const ImageNote& note) const;
  void paint_box(QPainter& painter, const ImageBox& box) const;
  void paint_mask(QPainter& painter, const ImageBox& box) const;
  void paint_kinds(QPainter& painter) const;
  void paint_depth_scale(QPainter& painter) const;
  int legend_height() const;
  /// The values under the cursor, else how far the scene is from the selected time.
  void paint_values(QPainter& painter) const;
  void paint_notes(QPainter& painter) const;
  /// Names where they have space, beside their boxes; that of the selected object always.
  void paint_names(QPainter& painter) const;
  QString empty_text() const;

  Browser& browser_;
  std::shared_ptr<const SceneContent> content_;  ///< null = none
  QImage image_;
  QImage kinds_;  ///< the tint; null = not shown, or not known
  bool depth_ = false, masks_ = true, shows_kinds_ = false;
  QString values_;  ///< under the cursor
  std::vector<ImageNote> notes_;
  std::optional<size_t> marked_;
};

class SceneImage;

/// The image of the selected scene, what is measured under the cursor, and, where annotators found something
/// in parts of it (texts, barcodes, answers of a visual search), these as a tree beside their boxes.
class SceneView : public QWidget {
  Q_OBJECT

 public:
  explicit SceneView(Browser& browser, QWidget* parent = nullptr);

  SceneImage& image() { return *image_; }
  QTreeWidget* notes() const { return tree_; }
  void show_notes(std::vector<ImageNote> notes);

 private:
  void refresh();

  Browser& browser_;
  SceneImage* image_;
  QTreeWidget* tree_;
  std::vector<ImageNote> notes_;
  int64_t scene_ = 0;  ///< that the notes are of; 0 = none
};

}  // namespace loci::gui

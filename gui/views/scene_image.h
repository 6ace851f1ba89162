#pragma once

#include <QImage>
#include <QWidget>
#include <optional>

#include "gui/browser.h"

namespace loci {

/// The picture of the chosen scene with the boxes of what was found in it; colour or depth. A click on a box
/// selects its object.
class SceneImage : public QWidget {
  Q_OBJECT

 public:
  explicit SceneImage(Browser& browser, QWidget* parent = nullptr);

  bool shows_depth() const { return depth_; }
  void show_depth(bool depth);
  QSize sizeHint() const override { return {380, 285}; }
  /// Where an object's box is on the widget; unset when it is not in this picture.
  std::optional<QRectF> box_of(int64_t object) const;

 protected:
  void paintEvent(QPaintEvent* event) override;
  void mousePressEvent(QMouseEvent* event) override;
  void mouseMoveEvent(QMouseEvent* event) override;

 private:
  void refresh();
  void remake_picture();
  const std::vector<ImageBox>& boxes() const;
  QRectF picture_area() const;
  QRectF on_widget(const ImageBox& box) const;
  const ImageBox* box_at(const QPointF& point) const;
  void paint_box(QPainter& painter, const ImageBox& box) const;
  QString empty_text() const;

  Browser& browser_;
  std::shared_ptr<const SceneContent> content_;  ///< null = none
  QImage picture_;
  bool depth_ = false;
};

}  // namespace loci

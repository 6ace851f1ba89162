#pragma once

#include <QWidget>

#include "gui/browser.h"

class QLabel;
class QProgressBar;
class QTableView;

namespace loci::gui {

class HistoryModel;
class ObjectDetailsView;

/// What is known of the chosen object: image, where, since when, how sure, and its history.
class ObjectCard : public QWidget {
  Q_OBJECT

 public:
  explicit ObjectCard(Browser& browser, QWidget* parent = nullptr);

  /// "object_12", the place's name, or empty.
  QString title() const;
  /// Name and value of every line shown, for copying.
  QString text() const;
  QTableView* history() const { return history_; }
  ObjectDetailsView* pages() const { return pages_; }

 private:
  void build_rows();
  void refresh();
  void show_object(const BelievedObject& object);
  void show_nothing(const QString& title, const QString& hint);
  void show_image();

  Browser& browser_;
  HistoryModel* model_;
  QLabel* image_;
  QLabel* title_;
  QLabel* hint_;
  QWidget* rows_;
  std::vector<std::pair<QString, QLabel*>> values_;
  QProgressBar* probability_;
  QTableView* history_;
  ObjectDetailsView* pages_;
  int64_t imaged_ = 0;  ///< object in the image
};

}  // namespace loci::gui

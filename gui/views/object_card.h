#pragma once

#include <QTabWidget>
#include <QWidget>

#include "gui/data/browser.h"
#include "gui/data/object_details.h"

class QLabel;
class QListWidget;
class QProgressBar;
class QTableView;
class QTableWidget;
class QTextBrowser;
class QVBoxLayout;

namespace loci::gui {

/// The pages of the object card beside its history: images from all sides, annotations with
/// histograms, and the reasons of the belief. Read when a page is in front.
class ObjectDetailsView : public QTabWidget {
  Q_OBJECT

 public:
  /// `history` is the first page.
  ObjectDetailsView(Browser& browser, QWidget* history, QWidget* parent = nullptr);

  QListWidget* images() const { return images_; }
  QTableWidget* annotations() const { return annotations_; }
  QTextBrowser* why() const { return why_; }
  const std::vector<Histogram>& histograms() const { return details_.histograms; }

 private:
  void refresh();
  void show_details(ObjectDetails& details);
  void show_histograms();

  Browser& browser_;
  QListWidget* images_;
  QTableWidget* annotations_;
  QVBoxLayout* histograms_;
  QTextBrowser* why_;
  ObjectDetails details_;
};

class HistoryModel;
class ObjectDetailsView;

/// What is known of the selected object: image, where, since when, how sure, and its history.
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
  void show_place(const std::string& place);
  void show_nothing(const QString& title, const QString& hint);
  void show_image();
  /// Adds to the state how surely what was seen last was this object, where that is in doubt.
  void show_certainty(const QString& state);

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

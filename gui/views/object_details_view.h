#pragma once

#include <QTabWidget>

#include "gui/browser.h"
#include "gui/data/object_details.h"

class QListWidget;
class QTableWidget;
class QTextBrowser;
class QVBoxLayout;

namespace loci::gui {

/// The pages of the object card beside its history: images from all sides, what experts say with
/// histograms, and why the memory believes what it does. Read when a page is looked at.
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

}  // namespace loci::gui

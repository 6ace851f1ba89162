#pragma once

#include <QObject>
#include <QPixmap>
#include <map>
#include <set>

#include "gui/browser.h"

namespace loci::gui {

/// The objects' newest images, small; read when they are first asked for.
class Thumbnails : public QObject {
  Q_OBJECT

 public:
  Thumbnails(Browser& browser, int side, QObject* parent = nullptr);

  /// Null while it is read, and when there is none.
  QPixmap of(int64_t object);

 Q_SIGNALS:
  void read(qlonglong object);

 private:
  void forget();

  Browser& browser_;
  int side_;
  std::string memory_;
  std::map<int64_t, QPixmap> images_;
  std::set<int64_t> asked_;
};

}  // namespace loci::gui

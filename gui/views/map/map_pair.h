#pragma once

#include <QSplitter>
#include <memory>

#include "gui/data/differences.h"
#include "gui/views/map/map_view.h"

class QLabel;

namespace loci::gui {

/// A belief that the selected one is compared with.
struct OtherBelief {
  std::shared_ptr<const OpenMemory> memory;  ///< null = none
  TimeNs time = 0;
  std::optional<TimeNs> known_at = {};
  QString title = {};
  /// Ids of the same object: here, there. Others have the same id in both.
  std::vector<std::pair<int64_t, int64_t>> same = {};
  bool is_same_memory = true;
};

/// The map, and beside it, when it is wanted, the map at another time or of another memory, seen by the same
/// eye; what differs has coloured edges in both.
class MapPair : public QSplitter {
  Q_OBJECT

 public:
  MapPair(Browser& browser, MapBackend backend, QWidget* parent = nullptr);

  MapView& now() { return *now_; }
  /// nullptr until something was shown beside it.
  MapView* then() { return then_; }
  Browser& then_browser() { return then_browser_; }
  bool is_pair() const { return then_ != nullptr && then_side_->isVisibleTo(this); }

  void show_other(const OtherBelief& other, const std::vector<Difference>& differences);
  void show_one();
  /// In both.
  void set_layer(MapLayer layer, bool visible);
  void change_point_size(int steps);

 Q_SIGNALS:
  void warned(const QString& text);

 private:
  QWidget* column(MapView* map, QLabel*& title);
  void make_other();
  void link_eyes();
  void link_selection();
  int64_t there(int64_t here) const;
  int64_t here(int64_t there) const;

  Browser& browser_;
  MapBackend backend_;
  Browser then_browser_;
  MapView* now_;
  MapView* then_ = nullptr;
  QLabel *now_title_, *then_title_ = nullptr;
  QWidget *now_side_, *then_side_ = nullptr;
  OtherBelief other_;
};

}  // namespace loci::gui

#pragma once

#include <QObject>
#include <memory>

#include "gui/data/browser_data.h"
#include "gui/selection.h"

namespace loci {

/// One open memory, what is chosen in it, and what is believed at the chosen time: what all views share. The
/// views read from here and write only to the selection.
class Browser : public QObject {
  Q_OBJECT

 public:
  explicit Browser(QObject* parent = nullptr);

  /// Shows another memory at its last scene; nullptr closes. The old selection is gone.
  void open(std::shared_ptr<const BrowserData> data);
  /// The same memory again, after it has changed: selection and time stay; a time at the end stays at the
  /// end.
  void renew(std::shared_ptr<const BrowserData> data);

  /// nullptr = nothing is open.
  const BrowserData* data() const { return data_.get(); }
  /// For work in another thread, which may outlast what is open.
  std::shared_ptr<const BrowserData> shared_data() const { return data_; }
  SelectionModel& selection() { return selection_; }
  const BelievedScene& belief() const { return belief_; }
  /// The scene that the chosen time falls into; nullptr when there is none.
  const SceneEntry* scene() const;
  /// The chosen object as believed at the chosen time; nullptr = none.
  const BelievedObject* selected_object() const;

  /// To the next (+1) or previous (-1) scene.
  void step(int direction);
  /// To the next or previous observation of the chosen object; to the next scene when none is chosen.
  void step_observation(int direction);
  void to_first();
  void to_last();

 Q_SIGNALS:
  void opened();          ///< another memory, or none
  void belief_changed();  ///< another time
  void selected();        ///< another object or place
  void failed(const QString& message);

 private:
  void refresh();

  std::shared_ptr<const BrowserData> data_;
  SelectionModel selection_;
  BelievedScene belief_;
};

}  // namespace loci

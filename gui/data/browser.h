#pragma once

#include <QObject>
#include <memory>

#include "gui/core/selection.h"
#include "gui/data/open_memory.h"
#include "gui/data/read_queue.h"
#include "gui/data/scene_content.h"

namespace loci::gui {

/// What is shown of one time.
struct Moment {
  Belief belief = {};
  std::shared_ptr<const SceneContent> content = {};  ///< of the scene that the time falls into; null = none
  std::shared_ptr<const ColoredCloud> cloud = {};    ///< its points; null = none
  std::string problem = {};                          ///< why the scene could not be read; empty = it could
};

/// One open memory, the selection in it, and what is believed at the selected time: what all views share. The
/// views read from here and write only to the selection. What is believed is read in the background: it
/// follows the selected time, and times that are passed too quickly are left out.
class Browser : public QObject {
  Q_OBJECT

 public:
  explicit Browser(QObject* parent = nullptr);

  /// Shows another memory at its last scene; nullptr closes. The old selection is gone.
  void open(std::shared_ptr<const OpenMemory> data);
  /// The same memory again, after it has changed: selection and time stay; a time at the end stays at the
  /// end.
  void renew(std::shared_ptr<const OpenMemory> data);

  /// nullptr = nothing is open.
  const OpenMemory* data() const { return data_.get(); }
  /// For work in another thread, which may outlast what is open.
  std::shared_ptr<const OpenMemory> shared_data() const { return data_; }
  SelectionModel& selection() { return selection_; }
  /// What was believed at belief().time, the last of the selected times that has been read.
  const Belief& belief() const { return moment_.belief; }
  const Moment& moment() const { return moment_; }
  /// For what else the views read.
  ReadQueue& reader() { return reader_; }
  /// The scene that the selected time falls into; nullptr when there is none.
  const memory::SceneRow* scene() const;
  /// The selected object as believed at the selected time; nullptr = none.
  const BelievedObject* selected_object() const;

  /// To the next (+1) or previous (-1) scene.
  void step(int direction);
  /// To the next or previous observation of the selected object; to the next scene when none is selected.
  void step_observation(int direction);
  void to_first();
  void to_last();

 Q_SIGNALS:
  void opened();          ///< another memory, or none
  void time_changed();    ///< another time is selected
  void belief_changed();  ///< and what was believed then has been read
  void selected();        ///< another object or place
  void failed(const QString& message);

 private:
  void refresh();
  /// Reads what is shown of the selected time, but for what `before` has of the same scene.
  void read(const Moment& before);
  void take(Moment moment);

  std::shared_ptr<const OpenMemory> data_;
  SelectionModel selection_;
  ReadQueue reader_;
  Moment moment_;
};

}  // namespace loci::gui

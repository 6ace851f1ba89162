#pragma once

#include <QObject>
#include <QString>
#include <QTimer>
#include <atomic>
#include <functional>
#include <memory>
#include <string>

#include "gui/data/open_memory.h"
#include "mapping/base/progress.h"

namespace loci::gui {

/// Opens memories in the background, and again when the file has changed.
class MemoryLoader : public QObject {
  Q_OBJECT

 public:
  using Result = std::shared_ptr<const OpenMemory>;

  explicit MemoryLoader(MemoryOpener opener, QObject* parent = nullptr);
  ~MemoryLoader() override;

  /// What was being opened is given up.
  void load(const QString& path);
  void cancel();
  bool is_loading() const { return stop_ != nullptr; }
  /// Reads what is new whenever a writer has changed the file of an open memory; empty = follows none.
  void follow(const QString& path, Result memory = {});
  /// Checks now whether the followed file has changed.
  void check();

 Q_SIGNALS:
  void started(const QString& path);
  void progressed(double fraction, const QString& text);
  void loaded(const QString& path, MemoryLoader::Result memory, bool again);
  void failed(const QString& path, const QString& reason, bool again);
  void finished();

 private:
  void load(const QString& path, std::function<Result(Progress&)> read, bool again);
  void finish();

  MemoryOpener opener_;
  std::shared_ptr<std::atomic<bool>> stop_;  ///< set while something is loaded
  QString followed_;
  Result memory_;           ///< as it was read last
  std::string state_;       ///< of the followed file when it was loaded
  std::string last_state_;  ///< of the file that was loaded last
  QTimer timer_;
};

}  // namespace loci::gui

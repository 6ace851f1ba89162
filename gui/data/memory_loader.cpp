#include "gui/data/memory_loader.h"

#include <QDateTime>
#include <QFileInfo>
#include <QPointer>

#include "gui/core/background.h"
#include "gui/core/task_timer.h"

namespace loci::gui {
namespace {

constexpr int kCheckMs = 1500;

/// Reports progress to the window, from the thread that loads.
class SignalledProgress : public Progress {
 public:
  SignalledProgress(QPointer<MemoryLoader> loader, std::shared_ptr<std::atomic<bool>> stop)
      : loader_(std::move(loader)), stop_(std::move(stop)) {}

  bool update(double fraction, std::string_view text) override {
    QMetaObject::invokeMethod(
        QCoreApplication::instance(),
        [loader = loader_, stop = stop_, fraction,
         words = QString::fromUtf8(text.data(), static_cast<int>(text.size()))] {
          if (!loader.isNull() && !*stop) Q_EMIT loader->progressed(fraction, words);
        },
        Qt::QueuedConnection);
    return !*stop_;
  }

 private:
  QPointer<MemoryLoader> loader_;
  std::shared_ptr<std::atomic<bool>> stop_;
};

/// Changes when a program writes to the memory: size and time of the file and of what is not yet in it.
std::string state_of(const QString& path) {
  QString state;
  for (const QString& name : {path, path + "-wal"}) {
    const QFileInfo file(name);
    if (file.exists() && file.size() > 0)
      state += QString("%1 %2;").arg(file.size()).arg(file.lastModified().toMSecsSinceEpoch());
  }
  return state.toStdString();
}

}  // namespace

MemoryLoader::MemoryLoader(MemoryOpener opener, QObject* parent)
    : QObject(parent), opener_(std::move(opener)) {
  timer_.setInterval(kCheckMs);
  connect(&timer_, &QTimer::timeout, this, &MemoryLoader::check);
}

MemoryLoader::~MemoryLoader() {
  if (stop_) *stop_ = true;
}

void MemoryLoader::load(const QString& path) {
  load(
      path,
      [opener = opener_, path](Progress& progress) -> Result { return opener(path.toStdString(), progress); },
      false);
}

void MemoryLoader::load(const QString& path, std::function<Result(Progress&)> read, bool again) {
  if (stop_) *stop_ = true;
  stop_ = std::make_shared<std::atomic<bool>>(false);
  Q_EMIT started(path);
  const std::string state = state_of(path);
  in_background<Result>(
      this,
      [read = std::move(read), stop = stop_, self = QPointer<MemoryLoader>(this)] {
        SignalledProgress progress(self, stop);
        return read(progress);
      },
      [this, path, state, again, stop = stop_](Result& memory) {
        if (*stop) return;
        name_task("taking the memory");
        finish();
        last_state_ = state;
        if (path == followed_) {
          state_ = state;
          memory_ = memory;
        }
        Q_EMIT loaded(path, memory, again);
      },
      [this, path, again, stop = stop_](const std::exception_ptr& error) {
        if (*stop) return;
        finish();
        Q_EMIT failed(path, reason_of(error), again);
      });
}

void MemoryLoader::cancel() {
  if (!stop_) return;
  *stop_ = true;
  finish();
}

void MemoryLoader::finish() {
  stop_.reset();
  Q_EMIT finished();
}

void MemoryLoader::follow(const QString& path, Result memory) {
  memory_ = std::move(memory);
  if (path == followed_) return;
  followed_ = path;
  state_ = last_state_;
  if (path.isEmpty())
    timer_.stop();
  else
    timer_.start();
}

void MemoryLoader::check() {
  if (followed_.isEmpty() || memory_ == nullptr || is_loading()) return;
  const std::string state = state_of(followed_);
  if (state == state_ || state.empty()) return;
  state_ = state;
  load(
      followed_, [memory = memory_](Progress& progress) -> Result { return memory->renewed(progress); },
      true);
}

}  // namespace loci::gui

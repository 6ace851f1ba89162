#pragma once

#include <QObject>
#include <QPointer>
#include <QString>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "gui/data/open_memory.h"

namespace loci::gui {

/// What is read first.
enum class Urgency {
  moment,     ///< what is shown of the selected time
  selection,  ///< what is shown of the selected object
  rest        ///< lanes, thumbnails
};

/// What becomes of a reading that has begun when the same is asked for again.
enum class Overtaken {
  dropped,   ///< only the last result is delivered
  delivered  ///< each that has begun is delivered: the view moves while a slider is dragged
};

/// Reads for the views from the open memory, one request after the other, in a thread of its own. A request
/// replaces an earlier one of the same owner for the same `what`.
class ReadQueue : public QObject {
  Q_OBJECT

 public:
  using Data = std::shared_ptr<const OpenMemory>;

  explicit ReadQueue(QObject* parent = nullptr);
  ~ReadQueue() override;

  /// What is read from now on; forgets all that was asked.
  void set_data(Data data);
  /// Runs `work` in the reading thread, then `done` with its result in this one; never when `owner` is gone,
  /// when it has asked for the same `what` again, or when another memory is open by then. Errors are reported
  /// by failed(). Does nothing when no memory is open.
  template <class Result>
  void read(QObject* owner, const std::string& what, Urgency urgency,
            std::function<Result(const OpenMemory&)> work, std::function<void(Result&)> done,
            Overtaken overtaken = Overtaken::dropped) {
    add({owner, owner, what, urgency, overtaken, 0,
         [work = std::move(work), done = std::move(done)](const Data& data) {
           auto result = std::make_shared<Result>(work(*data));
           return std::function<void()>([result, done] { done(*result); });
         }});
  }
  /// Takes back what an owner has asked for.
  void forget(QObject* owner, const std::string& what);
  /// Takes back everything that has not been read yet.
  void cancel();
  size_t waiting() const;

 Q_SIGNALS:
  void waiting_changed();
  void failed(const QString& reason);

 private:
  struct Job {
    QPointer<QObject> alive;
    const void* owner = nullptr;
    std::string what = {};
    Urgency urgency = Urgency::rest;
    Overtaken overtaken = Overtaken::dropped;
    uint64_t number = 0;
    std::function<std::function<void()>(const Data&)> work = {};
  };
  struct Shared;

  void add(Job job);
  void finish(const Job& job, const std::function<void()>& deliver, const QString& problem);
  static void run(const std::shared_ptr<Shared>& shared);

  std::shared_ptr<Shared> shared_;  ///< with the reading thread, which may outlast this
};

}  // namespace loci::gui

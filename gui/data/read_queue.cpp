#include "gui/data/read_queue.h"

#include <QCoreApplication>
#include <algorithm>
#include <deque>
#include <map>
#include <mutex>

#include "gui/core/background.h"
#include "gui/core/task_timer.h"

namespace loci::gui {

struct ReadQueue::Shared {
  mutable std::mutex mutex;
  ReadQueue* reader = nullptr;  ///< null when it is gone
  Data data;
  std::deque<Job> jobs;                                                ///< not begun
  std::map<std::pair<const void*, std::string>, uint64_t> last_asked;  ///< not delivered yet
  uint64_t asked = 0, taken_back = 0;  ///< numbers up to the second are not delivered
  bool runs = false;
};

ReadQueue::ReadQueue(QObject* parent) : QObject(parent), shared_(std::make_shared<Shared>()) {
  shared_->reader = this;
}

ReadQueue::~ReadQueue() {
  const std::lock_guard lock(shared_->mutex);
  shared_->reader = nullptr;
  shared_->jobs.clear();
}

void ReadQueue::set_data(Data data) {
  cancel();
  Data old;  // closed outside the lock
  const std::lock_guard lock(shared_->mutex);
  old = std::exchange(shared_->data, std::move(data));
}

void ReadQueue::cancel() {
  {
    const std::lock_guard lock(shared_->mutex);
    shared_->jobs.clear();
    shared_->last_asked.clear();
    shared_->taken_back = shared_->asked;
  }
  Q_EMIT waiting_changed();
}

void ReadQueue::forget(QObject* owner, const std::string& what) {
  const std::lock_guard lock(shared_->mutex);
  shared_->last_asked.erase({owner, what});
  std::erase_if(shared_->jobs, [&](const Job& job) { return job.owner == owner && job.what == what; });
}

size_t ReadQueue::waiting() const {
  const std::lock_guard lock(shared_->mutex);
  return shared_->last_asked.size();
}

void ReadQueue::add(Job job) {
  {
    const std::lock_guard lock(shared_->mutex);
    if (shared_->data == nullptr) return;
    std::erase_if(shared_->jobs,
                  [&](const Job& other) { return other.owner == job.owner && other.what == job.what; });
    job.number = ++shared_->asked;
    shared_->last_asked[{job.owner, job.what}] = job.number;
    const auto later = std::find_if(shared_->jobs.begin(), shared_->jobs.end(),
                                    [&](const Job& other) { return other.urgency > job.urgency; });
    shared_->jobs.insert(later, std::move(job));
    note_background_work();
    if (!std::exchange(shared_->runs, true)) reading_pool().start([shared = shared_] { run(shared); });
  }
  Q_EMIT waiting_changed();
}

void ReadQueue::run(const std::shared_ptr<Shared>& shared) {
  while (true) {
    Job job;
    Data data;
    {
      const std::lock_guard lock(shared->mutex);
      if (shared->jobs.empty()) {
        shared->runs = false;
        return;
      }
      job = std::move(shared->jobs.front());
      shared->jobs.pop_front();
      data = shared->data;
    }
    std::function<void()> deliver;
    QString problem;
    try {
      deliver = job.work(data);
    } catch (...) {
      problem = reason_of(std::current_exception());
    }
    QMetaObject::invokeMethod(
        QCoreApplication::instance(),
        [shared, job, deliver, problem] {
          // Only this thread ends a reader: it cannot go between here and there.
          if (shared->reader != nullptr) shared->reader->finish(job, deliver, problem);
        },
        Qt::QueuedConnection);
  }
}

void ReadQueue::finish(const Job& job, const std::function<void()>& deliver, const QString& problem) {
  {
    const std::lock_guard lock(shared_->mutex);
    const auto asked = shared_->last_asked.find({job.owner, job.what});
    if (asked == shared_->last_asked.end() || job.number <= shared_->taken_back) return;
    const bool is_last = asked->second == job.number;
    if (!is_last && job.overtaken == Overtaken::dropped) return;
    if (is_last) shared_->last_asked.erase(asked);
  }
  name_task("showing the " + job.what);
  if (!problem.isEmpty())
    Q_EMIT failed(problem);
  else if (!job.alive.isNull())
    deliver();
  Q_EMIT waiting_changed();
}

}  // namespace loci::gui

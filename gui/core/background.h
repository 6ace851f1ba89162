#pragma once

#include <QCoreApplication>
#include <QPointer>
#include <QString>
#include <QThreadPool>
#include <exception>
#include <functional>
#include <memory>

namespace loci::gui {

/// Counts what is started in the background, for finish_background().
void note_background_work();

/// Runs `work` in another thread and then, in the thread of the windows, `done` with its result or `failed`
/// with the reason; neither when `owner` is gone by then.
template <class Result>
void in_background(QObject* owner, const std::function<Result()>& work,
                   const std::function<void(Result&)>& done,
                   const std::function<void(const std::exception_ptr&)>& failed) {
  const QPointer<QObject> alive(owner);
  note_background_work();
  QThreadPool::globalInstance()->start([=] {
    auto result = std::make_shared<std::unique_ptr<Result>>();
    std::exception_ptr error;
    try {
      *result = std::make_unique<Result>(work());
    } catch (...) {
      error = std::current_exception();
    }
    QMetaObject::invokeMethod(
        QCoreApplication::instance(),
        [=] {
          if (alive.isNull()) return;
          if (error)
            failed(error);
          else
            done(**result);
        },
        Qt::QueuedConnection);
  });
}

/// The text of an exception.
QString reason_of(const std::exception_ptr& error);
/// Where the memory is read for the views: one thread, which long work cannot hold up.
QThreadPool& reading_pool();
/// Waits until nothing runs in the background and all results are delivered, with what follows from them.
void finish_background();

}  // namespace loci::gui

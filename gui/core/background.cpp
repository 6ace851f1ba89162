#include "gui/core/background.h"

#include <cstdint>

namespace loci::gui {
namespace {
uint64_t started = 0;  // work is only started in the thread of the windows
}

void note_background_work() {
  ++started;
}

QString reason_of(const std::exception_ptr& error) {
  try {
    std::rethrow_exception(error);
  } catch (const std::exception& exception) {
    return QString::fromUtf8(exception.what());
  }
}

QThreadPool& reading_pool() {
  static QThreadPool* pool = [] {
    auto* made = new QThreadPool(QThreadPool::globalInstance());
    made->setMaxThreadCount(1);
    return made;
  }();
  return *pool;
}

void finish_background() {
  uint64_t before = 0;
  do {
    before = started;
    QThreadPool::globalInstance()->waitForDone();
    reading_pool().waitForDone();
    QCoreApplication::sendPostedEvents();
  } while (started != before);
}

}  // namespace loci::gui

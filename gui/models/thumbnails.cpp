#include "gui/models/thumbnails.h"

#include "gui/text.h"

namespace loci::gui {

Thumbnails::Thumbnails(Browser& browser, int side, QObject* parent)
    : QObject(parent), browser_(browser), side_(side) {
  connect(&browser_, &Browser::opened, this, &Thumbnails::forget);
}

void Thumbnails::forget() {
  asked_.clear();  // what was being read is not told any more
  for (const auto& [object, image] : images_) asked_.insert(object);
  const std::string path = browser_.data() == nullptr ? "" : browser_.data()->info().path;
  if (path == memory_) return;  // it has grown: the images still show what they are of
  memory_ = path;
  images_.clear();
  asked_.clear();
}

QPixmap Thumbnails::of(int64_t object) {
  const auto known = images_.find(object);
  if (known != images_.end()) return known->second;
  if (asked_.insert(object).second)
    browser_.reader().read<QImage>(
        this, "thumbnail " + std::to_string(object), Urgency::rest,
        [object, side = side_, time = browser_.selection().time()](const BrowserData& memory) {
          const QImage image = image_of(memory.image(object, time));
          return image.isNull() ? image
                                : image.scaled(side, side, Qt::KeepAspectRatio, Qt::SmoothTransformation);
        },
        [this, object](const QImage& image) {
          if (!image.isNull()) images_[object] = QPixmap::fromImage(image);
          Q_EMIT read(object);
        });
  return {};
}

}  // namespace loci::gui

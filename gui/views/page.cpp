#include "gui/views/page.h"

namespace loci::gui {

void Page::set_looked_at(bool looked_at) {
  if (looked_at_ == looked_at) return;
  looked_at_ = looked_at;
  if (looked_at_) look();
}

}  // namespace loci::gui

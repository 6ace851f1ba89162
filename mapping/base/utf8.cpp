#include "mapping/base/utf8.h"

#include "mapping/base/error.h"
#include "mapping/base/json.h"

namespace loci {

void require_utf8(const std::string& text) {
  try {
    static_cast<void>(Json(text).dump());
  } catch (const Json::type_error&) {
    throw Error(Json(text).dump(-1, ' ', false, Json::error_handler_t::replace) + " is no UTF-8");
  }
}

}  // namespace loci

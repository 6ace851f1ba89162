#include "mapping/base/text/json.h"

#include <algorithm>
#include <unordered_set>

#include "mapping/base/error.h"
#include "mapping/base/files.h"
#include "mapping/base/text/text_file.h"

namespace loci {
namespace {

/// Builds a value in linear time: Json::parse looks through all keys of an object for each new one. Equal
/// keys are refused.
class JsonBuilder : public Json::json_sax_t {
 public:
  JsonBuilder(std::string_view text, const std::string& file) : text_(text), file_(file) {}
  Json take() { return std::move(result_); }

  bool null() override { return add(nullptr); }
  bool boolean(bool value) override { return add(value); }
  bool number_integer(number_integer_t value) override { return add(value); }
  bool number_unsigned(number_unsigned_t value) override { return add(value); }
  bool number_float(number_float_t value, const string_t&) override { return add(value); }
  bool string(string_t& value) override { return add(std::move(value)); }
  bool binary(binary_t& value) override { return add(Json::binary(std::move(value))); }
  bool start_array(size_t) override { return open(Json::array()); }
  bool start_object(size_t) override { return open(Json::object()); }
  bool end_array() override { return close(); }
  bool end_object() override {
    refuse_equal_keys(*open_.back().get_ptr<Json::object_t*>());
    return close();
  }
  bool key(string_t& name) override {
    keys_.push_back(std::move(name));
    return true;
  }
  bool parse_error(size_t position, const std::string&, const nlohmann::detail::exception& error) override {
    if (dynamic_cast<const Json::parse_error*>(&error) == nullptr)  // a number is too large for any type
      throw Error("JSON that cannot be read: " + std::string(error.what()), {file_, 0, {}});
    const auto end = text_.begin() + static_cast<std::ptrdiff_t>(std::min(position, text_.size()));
    const auto line = 1 + std::count(text_.begin(), end, '\n');
    throw Error("not valid JSON", {file_, static_cast<int>(line), {}}, "check the text around this line");
  }

 private:
  using Members = std::vector<std::pair<const std::string, Json>>;

  bool open(Json empty) {
    open_.push_back(std::move(empty));
    return true;
  }
  bool close() {
    Json value = std::move(open_.back());
    open_.pop_back();
    return add(std::move(value));
  }
  bool add(Json value) {
    if (open_.empty()) {
      result_ = std::move(value);
    } else if (auto* const members = open_.back().get_ptr<Json::object_t*>()) {
      static_cast<Members&>(*members).emplace_back(std::move(keys_.back()), std::move(value));
      keys_.pop_back();
    } else {
      open_.back().push_back(std::move(value));
    }
    return true;
  }
  void refuse_equal_keys(const Members& members) const {
    std::unordered_set<std::string_view> names;
    for (const auto& [name, value] : members)
      if (!names.insert(name).second)
        throw Error("the key '" + name + "' stands twice in one object", {file_, 0, {}},
                    "remove one of them");
  }

  std::string_view text_;
  const std::string& file_;
  std::vector<Json> open_;         ///< arrays and objects, outermost first
  std::vector<std::string> keys_;  ///< of members whose value is open
  Json result_;
};

}  // namespace

void check_json_depth(std::string_view text, const std::string& file) {
  int depth = 0, line = 1;
  bool quoted = false;
  for (size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '\n') ++line;
    if (quoted && c == '\\') {
      ++i;  // whatever it escapes
      continue;
    }
    if (c == '"') quoted = !quoted;
    if (quoted) continue;
    if (c == '[' || c == '{') ++depth;
    if (c == ']' || c == '}') --depth;
    if (depth > kMaxJsonDepth)
      throw Error("JSON that is nested too deeply", {file, line, {}},
                  "up to " + std::to_string(kMaxJsonDepth) + " levels can be read");
  }
}

Json parse_json(std::string_view text, const std::string& file) {
  check_json_depth(text, file);
  JsonBuilder builder(text, file);
  Json::sax_parse(text, &builder);
  return builder.take();
}

Json read_json(const std::filesystem::path& path) {
  return parse_json(read_text(path), path.string());
}

void write_json(const std::filesystem::path& path, const Json& json) {
  write_file_atomically(path, json.dump(2) + "\n");
}

}  // namespace loci

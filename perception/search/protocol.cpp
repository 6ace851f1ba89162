#include "perception/search/protocol.h"

#include <fmt/format.h>
#include <google/protobuf/message.h>
#include <google/protobuf/unknown_field_set.h>
#include <algorithm>
#include <array>
#include <vector>

#include "mapping/base/text/json.h"
#include "mapping/base/text/text.h"
#include "perception/search/goggles.pb.h"

namespace loci::perception {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::UnknownField;
using google::protobuf::UnknownFieldSet;

constexpr size_t kShownText = 60;
constexpr size_t kMaxUnknown = 1000;  ///< lines about an answer
constexpr int kMaxOpened = 16;        ///< levels of unnamed messages

bool is_printable(const std::string& text) {
  return std::all_of(text.begin(), text.end(), [](char c) { return c >= ' ' && c <= '~'; });
}

void list(const UnknownFieldSet& fields, const std::string& path, int depth, std::vector<std::string>& lines);

void list_bytes(const std::string& bytes, const std::string& path, int depth,
                std::vector<std::string>& lines) {
  if (!bytes.empty() && is_printable(bytes)) {
    const std::string shown = bytes.size() <= kShownText ? bytes : bytes.substr(0, kShownText) + "…";
    lines.push_back(fmt::format("{}: text '{}'", path, shown));
    return;
  }
  UnknownFieldSet inner;
  if (!bytes.empty() && depth < kMaxOpened && inner.ParseFromString(bytes))
    list(inner, path, depth + 1, lines);
  else
    lines.push_back(fmt::format("{}: {} bytes", path, bytes.size()));
}

void list(const UnknownFieldSet& fields, const std::string& path, int depth,
          std::vector<std::string>& lines) {
  for (int i = 0; i < fields.field_count() && lines.size() < kMaxUnknown; ++i) {
    const UnknownField& field = fields.field(i);
    const std::string name =
        path.empty() ? std::to_string(field.number()) : fmt::format("{}.{}", path, field.number());
    switch (field.type()) {
      case UnknownField::TYPE_VARINT:
        lines.push_back(fmt::format("{}: varint {}", name, field.varint()));
        break;
      case UnknownField::TYPE_FIXED32:
        lines.push_back(fmt::format("{}: fixed32 {}", name, field.fixed32()));
        break;
      case UnknownField::TYPE_FIXED64:
        lines.push_back(fmt::format("{}: fixed64 {}", name, field.fixed64()));
        break;
      case UnknownField::TYPE_LENGTH_DELIMITED:
        list_bytes(field.length_delimited(), name, depth, lines);
        break;
      case UnknownField::TYPE_GROUP:
        list(field.group(), name, depth + 1, lines);
        break;
    }
  }
}

void list(const Message& message, const std::string& path, std::vector<std::string>& lines) {
  const auto* reflection = message.GetReflection();
  list(reflection->GetUnknownFields(message), path, 0, lines);
  std::vector<const FieldDescriptor*> fields;
  reflection->ListFields(message, &fields);
  for (const FieldDescriptor* field : fields) {
    if (field->cpp_type() != FieldDescriptor::CPPTYPE_MESSAGE) continue;
    const std::string name = (path.empty() ? "" : path + ".") + field->name();
    if (!field->is_repeated()) {
      list(reflection->GetMessage(message, field), name, lines);
      continue;
    }
    for (int i = 0; i < reflection->FieldSize(message, field); ++i)
      list(reflection->GetRepeatedMessage(message, field, i), fmt::format("{}[{}]", name, i), lines);
  }
}

/// How a message that was read from `bytes` differs from what we would make of it (§5.4.2): it is encoded
/// again with what its definition names, and where the two differ, every field that is not named is listed by
/// its path, number, kind and value ("info[0].ui_info.99: varint 7"); what looks like a message is opened. A
/// last line tells of bytes that are lost although every field is named: a field that is said twice, a number
/// that is spelt long.
std::vector<std::string> structural_differences(const Message& message, std::string_view bytes) {
  const std::string again = message.SerializePartialAsString();
  std::vector<std::string> lines;
  list(message, "", lines);
  // Fields may come in any order, which does not change the length.
  if (again.size() != bytes.size())
    lines.push_back(fmt::format("encoded again it has {} bytes instead of {}", again.size(), bytes.size()));
  return lines;
}

constexpr int kFarthest = 1 << 20;  // pixels

/// A property and the field of a message that carries it.
struct TextField {
  const char* key;
  const char* field;
};

constexpr std::array<TextField, 6> kProductTexts = {{{"authors", "authors"},
                                                     {"publisher", "publisher"},
                                                     {"year", "year"},
                                                     {"isbn", "isbn"},
                                                     {"manufacturer", "manufacturer"},
                                                     {"product_id", "product_cid"}}};
constexpr std::array<TextField, 2> kImageTexts = {
    {{"image_url", "image_highres"}, {"image_site", "image_site"}}};
constexpr std::array<TextField, 3> kUploaderTexts = {
    {{"uploader", "name"}, {"uploader_url", "user_url"}, {"uploader_image", "image_url"}}};
constexpr std::array<TextField, 1> kUploadTexts = {{{"user_text", "text"}}};
constexpr std::array<TextField, 1> kUiTexts = {{{"location", "location"}}};
constexpr std::array<TextField, 1> kPriceTexts = {{{"price", "range"}}};
constexpr std::array<TextField, 1> kCommentTexts = {{{"comment", "comment"}}};
constexpr std::array<TextField, 1> kStoreTexts = {{{"store", "store"}}};
constexpr std::array<TextField, 1> kGroupTexts = {{{"category", "group_name"}}};

/// Text that JSON and XML can carry: bytes that are no UTF-8 become the sign for that.
std::string mended(const std::string& text) {
  return Json::parse(Json(text).dump(-1, ' ', false, Json::error_handler_t::replace)).get<std::string>();
}

void add_property(SearchResult& result, const std::string& key, const std::string& value) {
  if (!key.empty() && !value.empty() && result.property(key).empty())
    result.properties.emplace_back(key, mended(value));
}

void add_link(SearchResult& result, const std::string& name, const std::string& url) {
  if (!url.empty()) result.links.emplace_back(mended(name), mended(url));
}

template <size_t N>
void read_texts(const Message& message, const std::array<TextField, N>& texts, SearchResult& result) {
  for (const TextField& text : texts)
    add_property(
        result, text.key,
        message.GetReflection()->GetString(message, message.GetDescriptor()->FindFieldByName(text.field)));
}

/// Writes the properties that the message carries, and asks for the message only if there are any.
template <size_t N, class Get>
void write_texts(const SearchResult& result, const std::array<TextField, N>& texts, const Get& message) {
  for (const TextField& text : texts) {
    const std::string value = result.property(text.key);
    if (value.empty()) continue;
    Message& target = *message();
    target.GetReflection()->SetString(&target, target.GetDescriptor()->FindFieldByName(text.field), value);
  }
}

template <size_t N>
bool holds(const std::array<TextField, N>& texts, const std::string& key) {
  return std::any_of(texts.begin(), texts.end(), [&](const TextField& text) { return key == text.key; });
}

/// Whether a field of its own carries the property.
bool has_field(const std::string& key) {
  return holds(kProductTexts, key) || holds(kImageTexts, key) || holds(kUploaderTexts, key) ||
         holds(kUploadTexts, key) || holds(kUiTexts, key) || holds(kPriceTexts, key) ||
         holds(kCommentTexts, key) || holds(kStoreTexts, key) || holds(kGroupTexts, key);
}

cv::Rect rect_of(const goggles::Coords& coords) {
  const auto within = [](int value, int least) { return std::clamp(value, least, kFarthest); };
  return {within(coords.x(), -kFarthest), within(coords.y(), -kFarthest), within(coords.width(), 0),
          within(coords.height(), 0)};
}

void write_rect(const cv::Rect& rect, goggles::Coords& coords) {
  coords.set_x(rect.x);
  coords.set_width(rect.width);
  coords.set_y(rect.y);
  coords.set_height(rect.height);
}

SearchCategory category_of(const std::string& text, const goggles::UIInfo& ui) {
  const std::string name = lower_case(text);
  for (const char* code : {"barcode", "qr code", "ean-", "upc-"})
    if (name.find(code) != std::string::npos) return SearchCategory::kBarcode;
  const std::array<std::pair<const char*, SearchCategory>, 7> beginnings = {
      {{"product", SearchCategory::kProduct},
       {"text", SearchCategory::kText},
       {"book", SearchCategory::kBook},
       {"logo", SearchCategory::kLogo},
       {"landmark", SearchCategory::kLandmark},
       {"similar image", SearchCategory::kSimilarImage},
       {"user submitted", SearchCategory::kUserSubmitted}}};
  for (const auto& [beginning, category] : beginnings)
    if (name.starts_with(beginning)) return category;
  // The field may hold a subtitle instead: then what else is there tells.
  const goggles::Product& product = ui.product();
  if (product.has_isbn() || product.has_authors()) return SearchCategory::kBook;
  if (ui.has_product() || ui.has_product_info() || ui.has_hierarchy_path()) return SearchCategory::kProduct;
  if (ui.translation().word_position_size() > 0) return SearchCategory::kText;
  if (ui.has_uploaded_info()) return SearchCategory::kUserSubmitted;
  if (ui.has_location()) return SearchCategory::kLandmark;
  if (ui.has_image_urls()) return SearchCategory::kSimilarImage;
  return SearchCategory::kOther;
}

void read_product(const goggles::UIInfo& ui, SearchResult& result) {
  const goggles::Product& product = ui.product();
  read_texts(product, kProductTexts, result);
  read_texts(product.price_range(), kPriceTexts, result);
  for (const goggles::ProductMatch& match : product.match()) {
    read_texts(match, kStoreTexts, result);
    read_texts(match.price_range(), kPriceTexts, result);
    add_link(result, match.store().empty() ? "store" : match.store(), match.link());
  }
  // The last level is the narrowest group.
  for (int i = product.hierarchy_size(); i-- > 0;) read_texts(product.hierarchy(i), kGroupTexts, result);
  const auto& levels = ui.hierarchy_path().levels().level();
  for (int i = levels.size(); i-- > 0;) read_texts(levels[i], kGroupTexts, result);
  for (const auto* pairs : {&ui.product_info().properties(), &ui.product_info().geo_info()})
    for (const goggles::StringPair& pair : *pairs)
      add_property(result, normalised_key(mended(pair.key())), pair.value());
}

void read_words(const goggles::TranslationResult& translation, SearchResult& result) {
  for (const std::string& text : translation.translation()) result.translations.push_back(mended(text));
  for (const goggles::WordPos& position : translation.word_position()) {
    SearchWord word{mended(position.chars()), rect_of(position.word_coords()), {}};
    for (const goggles::Coords& coords : position.char_coords()) word.characters.push_back(rect_of(coords));
    result.words.push_back(std::move(word));
  }
}

SearchResult read_info(const goggles::Info& info) {
  const goggles::UIInfo& ui = info.ui_info();
  SearchResult result;
  result.category = category_of(info.category(), ui);
  result.category_text = mended(info.category());
  result.title = mended(info.title());
  if (ui.has_coords()) result.region = rect_of(ui.coords());
  result.language = mended(ui.language());
  result.text = mended(ui.result_string().empty() ? info.direct_result().result() : ui.result_string());
  result.description =
      mended(ui.result_description().empty() ? info.direct_result().description() : ui.result_description());
  result.preview_url = mended(ui.image_urls().image_show());
  add_property(result, "additional_info", ui.additional_info());
  read_product(ui, result);
  read_texts(ui.image_urls(), kImageTexts, result);
  read_texts(ui.uploaded_info().uploader(), kUploaderTexts, result);
  read_texts(ui.uploaded_info(), kUploadTexts, result);
  read_texts(ui, kUiTexts, result);
  read_texts(ui.comment(), kCommentTexts, result);
  read_words(ui.translation(), result);
  for (const goggles::ActionList& list : ui.actions())
    for (const goggles::Action& action : list.action()) add_link(result, action.action_title(), action.url());
  add_link(result, "more", ui.search_more());
  add_link(result, "buy", ui.buy_link());
  add_link(result, "report abuse", ui.uploaded_info().abuse_link());
  add_link(result, "search", info.query().url());
  return result;
}

void write_properties(const SearchResult& result, goggles::UIInfo& ui) {
  const auto product = [&] { return ui.mutable_product(); };
  write_texts(result, kProductTexts, product);
  write_texts(result, kPriceTexts, [&] { return product()->mutable_price_range(); });
  write_texts(result, kStoreTexts, [&] { return product()->add_match(); });
  write_texts(result, kGroupTexts, [&] { return product()->add_hierarchy(); });
  write_texts(result, kImageTexts, [&] { return ui.mutable_image_urls(); });
  write_texts(result, kUploaderTexts, [&] { return ui.mutable_uploaded_info()->mutable_uploader(); });
  write_texts(result, kUploadTexts, [&] { return ui.mutable_uploaded_info(); });
  write_texts(result, kUiTexts, [&] { return &ui; });
  write_texts(result, kCommentTexts, [&] { return ui.mutable_comment(); });
  for (const auto& [key, value] : result.properties) {
    if (has_field(key)) continue;
    goggles::StringPair& pair = *ui.mutable_product_info()->add_properties();
    pair.set_key(key);
    pair.set_value(value);
  }
}

void write_details(const SearchResult& result, goggles::UIInfo& ui) {
  if (!result.region.empty()) write_rect(result.region, *ui.mutable_coords());
  if (!result.language.empty()) ui.set_language(result.language);
  if (!result.text.empty()) ui.set_result_string(result.text);
  if (!result.description.empty()) ui.set_result_description(result.description);
  if (!result.preview_url.empty()) ui.mutable_image_urls()->set_image_show(result.preview_url);
  write_properties(result, ui);
  for (const std::string& text : result.translations) ui.mutable_translation()->add_translation(text);
  for (const SearchWord& word : result.words) {
    goggles::WordPos& position = *ui.mutable_translation()->add_word_position();
    position.set_chars(word.text);
    write_rect(word.region, *position.mutable_word_coords());
    for (const cv::Rect& character : word.characters) write_rect(character, *position.add_char_coords());
  }
  if (result.links.empty()) return;
  goggles::ActionList& actions = *ui.add_actions();
  for (const auto& [name, url] : result.links) {
    goggles::Action& action = *actions.add_action();
    action.set_action_title(name);
    action.set_url(url);
  }
}

template <class Parsed>
Parsed parsed(std::string_view bytes, const std::string& what) {
  Parsed message;
  if (bytes.size() > static_cast<size_t>(std::numeric_limits<int>::max()) ||
      !message.ParseFromArray(bytes.data(), static_cast<int>(bytes.size())))
    throw Error("what came is no " + what + " of the visual-search protocol");
  return message;
}

}  // namespace

std::string encode(const SearchRequest& request) {
  goggles::GogglesRequest message;
  message.mutable_image()->mutable_image()->set_image_bytes(request.jpeg);
  goggles::LanguageID& language = *message.mutable_language();
  language.set_language(request.language);
  language.set_country(request.country);
  if (request.details) {
    language.mutable_enable_ui()->set_value_1(1);
    language.mutable_enable_ui()->set_value_7(1);
  }
  return message.SerializeAsString();
}

SearchRequest decode_request(std::string_view bytes) {
  const auto message = parsed<goggles::GogglesRequest>(bytes, "request");
  const goggles::LanguageID& language = message.language();
  return {message.image().image().image_bytes(), language.language(), language.country(),
          language.has_enable_ui() && language.enable_ui().value_1() != 0};
}

std::string encode(const std::vector<SearchResult>& results, bool details) {
  goggles::GogglesResponse message;
  for (const SearchResult& result : results) {
    goggles::Info& info = *message.add_info();
    info.set_title(result.title);
    info.set_category(result.category_text.empty() ? name_of(result.category) : result.category_text);
    if (details) write_details(result, *info.mutable_ui_info());
  }
  return message.SerializeAsString();
}

SearchAnswer decode_response(std::string_view bytes) {
  const auto message = parsed<goggles::GogglesResponse>(bytes, "response");
  SearchAnswer answer;
  for (const goggles::Info& info : message.info()) answer.results.push_back(read_info(info));
  for (const goggles::Info& info : message.alternatives().alternative_info())
    answer.results.push_back(read_info(info));
  for (const goggles::Info& info : message.alternatives().info()) answer.results.push_back(read_info(info));
  answer.unknown = structural_differences(message, bytes);
  return answer;
}

}  // namespace loci::perception

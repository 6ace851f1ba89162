#include "memory/server/tool_server.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>

#include "mapping/base/text/base64.h"
#include "mapping/base/text/json.h"
#include "mapping/base/text/percent.h"
#include "mapping/base/text/text.h"
#include "mapping/base/time.h"
#include "memory/edits/edit_actions.h"
#include "memory/questions/names/map_names.h"
#include "memory/questions/question.h"
#include "memory/questions/replies/reply.h"
#include "memory/sentences/natural_language.h"
#include "memory/store/store.h"

namespace loci::memory {
namespace {

constexpr const char* kVersions[] = {"2025-11-25", "2025-06-18", "2025-03-26",
                                     "2024-11-05"};  ///< newest first
constexpr size_t kPage = 100;                        ///< resources to a list
constexpr size_t kMaxBatch = 50;                     ///< messages
constexpr std::string_view kObjectUri = "loci://object/", kPlaceUri = "loci://place/",
                           kSceneUri = "loci://scene/", kImage = "/image";
constexpr const char* kJsonType = "application/json";
constexpr std::string_view kEditPrefix = "edit-";
constexpr const char* kEditList = "edit-list";
constexpr const char* kFirstWithoutBatches = "2025-06-18";

/// Codes of JSON-RPC 2.0, and the protocol's own for a resource that is not there.
enum Code {
  unknown_method = -32601,
  invalid_params = -32602,
  internal_error = -32603,
  no_resource = -32002,
};

struct ProtocolError {
  Code code;
  std::string text;
};

Json error_reply(const Json& id, Code code, const std::string& text) {
  return {{"jsonrpc", "2.0"}, {"id", id}, {"error", {{"code", code}, {"message", text}}}};
}

std::string text_of(const Json& params, const char* key) {
  if (!params.contains(key) || !params[key].is_string())
    throw ProtocolError{invalid_params, fmt::format("'{}' is missing or is not a string", key)};
  return params[key].get<std::string>();
}

// ---- Tools

bool is_offered(const Parameter& parameter) {
  return parameter.type != ParameterType::file;
}

/// As which JSON a value may be given: argument_text() reads all of them.
Json types_of(ParameterType type) {
  switch (type) {
    case ParameterType::number:
    case ParameterType::length:
      return {"string", "number"};
    case ParameterType::spot:
    case ParameterType::point:
      return {"string", "array"};
    default:
      return "string";
  }
}

Json schema_of(const Parameter& parameter) {
  std::string help = fmt::format("{} ({})", parameter.help, to_text(parameter.type));
  if (!parameter.default_text.empty()) help += fmt::format("; default: {}", parameter.default_text);
  Json schema = {{"type", types_of(parameter.type)}, {"description", help}};
  if (!parameter.choices.empty()) schema["enum"] = parameter.choices;
  return schema;
}

Json tool(const std::string& name, const std::string& description, const std::vector<Parameter>& parameters,
          bool read_only) {
  Json properties = Json::object();
  std::vector<std::string> required;
  for (const Parameter& parameter : parameters) {
    if (!is_offered(parameter)) continue;
    properties[parameter.name] = schema_of(parameter);
    if (parameter.required) required.push_back(parameter.name);
  }
  Json hints = {{"readOnlyHint", read_only}, {"openWorldHint", false}};
  if (!read_only) hints["destructiveHint"] = false;  // Each edit can be undone.
  return {{"name", name},
          {"description", description},
          {"inputSchema",
           {{"type", "object"},
            {"properties", properties},
            {"required", required},
            {"additionalProperties", false}}},
          {"annotations", hints}};
}

constexpr const char* kBefore = "before";

/// Of `ask`, apart from `before`, which is a list.
std::vector<Parameter> ask_parameters() {
  std::vector<Parameter> parameters = {
      {.name = "question", .help = "e.g. \"Where is the red cup?\"", .required = true}};
  for (const Parameter& parameter : find_question("where")->all_parameters())
    if (parameter.name == "at" || parameter.name == "known-at") parameters.push_back(parameter);
  return parameters;
}

Json ask_tool() {
  Json ask = tool("ask", "Answers a question or a task in English", ask_parameters(), true);
  ask["inputSchema"]["properties"][kBefore] = {
      {"type", "array"},
      {"items", {{"type", "string"}}},
      {"description", "Sentences that were asked before, in order: what \"it\" and \"there\" refer to"}};
  return ask;
}

Json tools(bool allow_edits) {
  Json list = Json::array({ask_tool()});
  for (const Question& question : questions())
    list.push_back(tool(question.name, question.description, question.all_parameters(), true));
  if (!allow_edits) return list;
  for (const EditAction& action : edit_actions())
    list.push_back(
        tool(std::string(kEditPrefix) + action.name, action.description, action.parameters, false));
  list.push_back(tool(kEditList, "Lists the edits that hold, and those that were undone", {}, true));
  return list;
}

/// People's words, and the same as data. Data that is not an object becomes one, as the protocol asks.
Json tool_result(const std::string& text, const Json& data, bool is_error = false) {
  return {{"content", Json::array({{{"type", "text"}, {"text", text}}})},
          {"structuredContent", data.is_object() ? data : Json{{"answer", data}}},
          {"isError", is_error}};
}

/// A value as people write it: the numbers of a point stand between commas.
std::string argument_text(const std::string& name, const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number_float() && value.get<double>() == std::round(value.get<double>()))
    return fmt::format("{:.0f}", value.get<double>());  // 2.0 is a whole number
  if (value.is_number()) return value.dump();
  const bool numbers = value.is_array() && !value.empty() &&
                       std::ranges::all_of(value, [](const Json& each) { return each.is_number(); });
  if (!numbers) throw Error(fmt::format("'{}' is neither a string, a number nor a list of numbers", name));
  std::vector<std::string> texts;
  for (const Json& each : value) texts.push_back(each.dump());
  return joined(texts, ",");
}

Query query_of(const std::string& asked, const std::vector<Parameter>& parameters, const Json& arguments) {
  Query query{.question = asked};
  for (const auto& [name, value] : arguments.items()) {
    if (value.is_null()) continue;  // as many clients write what they leave out
    const auto parameter = std::ranges::find(parameters, name, &Parameter::name);
    if (parameter != parameters.end() && !is_offered(*parameter))
      throw Error(fmt::format("'{}' names a file, which is not offered here", name));
    // What is unknown is refused by its name.
    query.arguments[name] = parameter == parameters.end() ? value.dump() : argument_text(name, value);
  }
  return query;
}

Json ask_in_words(const Store& store, Json arguments) {
  NaturalLanguageQuestion question;
  const Json before = arguments.value(kBefore, Json::array());
  if (!before.is_array() ||
      !std::ranges::all_of(before, [](const Json& sentence) { return sentence.is_string(); }))
    throw Error(fmt::format("'{}' is not a list of sentences", kBefore));
  for (const Json& sentence : before) question.sentences.push_back(sentence.get<std::string>());
  arguments.erase(kBefore);
  const std::vector<Parameter> parameters = ask_parameters();
  const Query query = query_of("ask", parameters, arguments);
  check_arguments("ask", parameters, query);
  question.sentences.push_back(query.argument("question"));
  question.as_of = read_as_of(store, query.argument("at"), query.argument("known-at"));
  const NaturalLanguageAnswer answer = ask(store, question).back();
  return tool_result(to_text(answer, TimeWriter(store)), to_json(answer), !answer.query);
}

Json arguments_of(const Json& params) {
  Json arguments = params.contains("arguments") ? params["arguments"] : Json::object();
  if (!arguments.is_object()) throw ProtocolError{invalid_params, "'arguments' is not an object"};
  return arguments;
}

/// What a question or an edit objects to is a result that the model can learn from, not an error of the
/// protocol.
template <class Function>
Json result_of(Function&& function) {
  try {
    return function();
  } catch (const Error& error) {
    return tool_result(error.what(), {{"error", error.what()}}, true);
  }
}

Json call_question(const Store& store, const Json& params) {
  const std::string name = text_of(params, "name");
  const Json arguments = arguments_of(params);
  const Question* question = find_question(name);
  if (question == nullptr && name != "ask")
    throw ProtocolError{invalid_params, fmt::format("unknown tool '{}'", name)};
  return result_of([&] {
    if (question == nullptr) return ask_in_words(store, arguments);
    const Query query = query_of(name, question->all_parameters(), arguments);
    const Answer answer = question->ask(store, query);
    const Reply reply = question->reply(store, query, answer);
    return tool_result(full_text(reply, answer, TimeWriter(store)), full_json(reply, answer));
  });
}

/// The edit that a message calls; nullptr when it calls something else.
const EditAction* called_edit(const Json& message, const Json& params) {
  if (message["method"] != "tools/call" || !params.contains("name") || !params["name"].is_string())
    return nullptr;
  const std::string name = params["name"].get<std::string>();
  return name.starts_with(kEditPrefix) ? find_edit_action(name.substr(kEditPrefix.size())) : nullptr;
}

// ---- Resources

Json resource(std::string_view prefix, const std::string& name, const std::string& description) {
  return {{"uri", std::string(prefix) + percent_encoded(name)},
          {"name", name},
          {"description", description},
          {"mimeType", kJsonType}};
}

Json resources(const Store& store) {
  Json list = Json::array();
  for (const PlaceRow& place : named_places(store))
    list.push_back(resource(kPlaceUri, place.name, "What is there now"));
  const Json objects = ask(store, {.question = "objects"}).to_json();
  for (const Json& object : objects["objects"])
    list.push_back(resource(kObjectUri, object["object"].get<std::string>(),
                            "What is known of the object, and where it was"));
  return list;
}

/// A page of a list; the cursor is the number of its first element.
Json page_of(const Json& list, const char* key, const Json& params) {
  size_t begin = 0;
  if (params.contains("cursor")) {
    const std::string cursor = text_of(params, "cursor");
    const auto [end, failure] = std::from_chars(cursor.data(), cursor.data() + cursor.size(), begin);
    if (failure != std::errc() || end != cursor.data() + cursor.size() || begin > list.size())
      throw ProtocolError{invalid_params, "the cursor is not one of this list"};
  }
  const size_t end = std::min(list.size(), begin + kPage);
  Json page = {{key, Json::array()}};
  for (size_t i = begin; i < end; ++i) page[key].push_back(list[i]);
  if (end < list.size()) page["nextCursor"] = std::to_string(end);
  return page;
}

Json templates() {
  const auto one = [](const std::string& uri, const char* name, const char* description, const char* type) {
    return Json{{"uriTemplate", uri}, {"name", name}, {"description", description}, {"mimeType", type}};
  };
  return Json::array({one(std::string(kObjectUri) + "{object}", "object",
                          "What is known of an object, by its number (object_12)", kJsonType),
                      one(std::string(kPlaceUri) + "{place}", "place", "What is at a place now", kJsonType),
                      one(std::string(kSceneUri) + "{scene}" + std::string(kImage), "image",
                          "The colour image of a scene, by its number", "image/jpeg")});
}

Json scene_image(const Store& store, const std::string& uri, std::string_view number) {
  Id id = 0;
  const auto [end, failure] = std::from_chars(number.data(), number.data() + number.size(), id);
  if (failure != std::errc() || end != number.data() + number.size())
    throw ProtocolError{no_resource, "scenes have numbers"};
  const SceneRow scene = store.scene(id);
  if (!scene.image) throw ProtocolError{no_resource, "no image of this scene is stored"};
  const BlobRow blob = store.blob(*scene.image);
  return {{"uri", uri}, {"mimeType", blob.media}, {"blob", base64_from_bytes(blob.bytes)}};
}

Json read_resource(const Store& store, const Json& params) {
  const std::string uri = text_of(params, "uri");
  const auto answer = [&](const std::string& question, const std::string& parameter,
                          const std::string& value) {
    return ask(store, {.question = question, .arguments = {{parameter, value}}}).to_json();
  };
  Json content;
  try {
    const std::string rest = percent_decoded(uri).value_or(uri);
    if (rest.starts_with(kObjectUri)) {
      const std::string name(rest.substr(kObjectUri.size()));
      const Json known = {{"about", answer("about", "object", name)},
                          {"history", answer("history", "object", name)}};
      content = {{"uri", uri}, {"mimeType", kJsonType}, {"text", known.dump()}};
    } else if (rest.starts_with(kPlaceUri)) {
      const std::string name(rest.substr(kPlaceUri.size()));
      content = {{"uri", uri}, {"mimeType", kJsonType}, {"text", answer("on", "place", name).dump()}};
    } else if (rest.starts_with(kSceneUri) && rest.ends_with(kImage)) {
      content = scene_image(
          store, uri,
          std::string_view(rest).substr(kSceneUri.size(), rest.size() - kSceneUri.size() - kImage.size()));
    }
  } catch (const Error& error) {
    throw ProtocolError{no_resource, error.what()};
  }
  if (content.is_null()) throw ProtocolError{no_resource, fmt::format("unknown resource '{}'", uri)};
  return {{"contents", Json::array({content})}};
}

// ---- Session

Json initialize(const Store& store, const Json& params) {
  const std::string wanted = text_of(params, "protocolVersion");
  std::string instructions =
      "What was seen of the objects of a home, by a robot or a camera. Answers hold probabilities, and the "
      "scenes that they follow from; 'not observed' means that nobody looked.";
  if (const auto last = store.last_scene())
    instructions += fmt::format(" The memory ends at {}; questions without a time refer to that moment.",
                                format_time(last->time));
  return {{"protocolVersion", is_protocol_version(wanted) ? wanted : kVersions[0]},
          {"capabilities", {{"tools", Json::object()}, {"resources", Json::object()}}},
          {"instructions", instructions}};
}

using Method = Json (*)(const Store& store, const Json& params);

const std::map<std::string, Method>& methods() {
  static const std::map<std::string, Method> all = {
      {"initialize", initialize},
      {"ping", [](const Store&, const Json&) { return Json::object(); }},
      {"tools/call", call_question},
      {"resources/list",
       [](const Store& store, const Json& params) { return page_of(resources(store), "resources", params); }},
      {"resources/templates/list",
       [](const Store&, const Json&) {
         return Json{{"resourceTemplates", templates()}};
       }},
      {"resources/read", read_resource},
  };
  return all;
}

}  // namespace

ToolServer::ToolServer(std::filesystem::path memory, std::string version, bool allow_edits)
    : ToolServer([memory = std::move(memory)] { return memory; }, std::move(version), allow_edits) {}

ToolServer::ToolServer(std::function<std::filesystem::path()> memory, std::string version, bool allow_edits)
    : memory_(std::move(memory)), version_(std::move(version)), allow_edits_(allow_edits) {
  Store::open_read(memory_());
}

Json error_reply(MessageError error, const std::string& text) {
  return error_reply(nullptr, static_cast<Code>(error), text);
}

bool is_protocol_version(std::string_view version) {
  return std::ranges::count(kVersions, version) > 0;
}

bool takes_batches(std::string_view version) {
  return version < kFirstWithoutBatches;
}

bool is_initialize(const Json& message) {
  return message.is_object() && message.value("method", Json()) == "initialize";
}

std::string message_text(const Json& message) {
  return message.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::filesystem::path ToolServer::memory() const {
  const std::lock_guard lock(finding_);
  return memory_();
}

Json ToolServer::call_edit(const EditAction& action, const Json& params) const {
  const Json arguments = arguments_of(params);
  return result_of([&] {
    const Query query = query_of(action.name, action.parameters, arguments);
    const std::lock_guard lock(editing_);
    Store store = Store::open_write(memory());
    const Edit edit = make_edit(store, query);
    return tool_result(summary(edit), result_json(edit));
  });
}

Json ToolServer::list_edits(const Json& params) const {
  const Json arguments = arguments_of(params);
  return result_of([&] {
    check_arguments(kEditList, {}, query_of(kEditList, {}, arguments));
    const EditList list = edits(Store::open_read(memory()));
    return tool_result(to_text(list), to_json(list));
  });
}

std::optional<std::string> LineTransport::reply(std::string_view line) {
  std::optional<Json> json;
  try {
    const Json message = parse_json(line, "");
    json = message.is_array() && !takes_batches(version_)
               ? error_reply(MessageError::not_a_message, "one message at a time")
               : server_.answer(message);
    if (is_initialize(message) && json && json->contains("result"))
      version_ = json->at("result").at("protocolVersion").get<std::string>();
  } catch (const Error& error) {
    json = error_reply(MessageError::not_json, error.what());
  }
  if (!json) return std::nullopt;
  return message_text(*json);
}

std::optional<Json> ToolServer::answer(const Json& message) const {
  if (!message.is_array()) return answer_one(message);
  if (message.empty() || message.size() > kMaxBatch)
    return error_reply(MessageError::not_a_message, fmt::format("a batch has 1 to {} messages", kMaxBatch));
  Json replies = Json::array();
  for (const Json& one : message)
    if (auto reply = answer_one(one)) replies.push_back(std::move(*reply));
  if (replies.empty()) return std::nullopt;
  return replies;
}

std::optional<Json> ToolServer::answer_one(const Json& message) const {
  if (!message.is_object() || message.value("jsonrpc", Json()) != "2.0")
    return error_reply(MessageError::not_a_message, "this is not a message of JSON-RPC 2.0");
  const bool is_reply = message.contains("result") || message.contains("error");
  if (is_reply && !message.contains("method")) return std::nullopt;  // This server asks for nothing.
  const Json id = message.value("id", Json());
  const bool is_id = id.is_string() || id.is_number_integer();
  if (!message.value("method", Json()).is_string())
    return error_reply(is_id ? id : Json(), static_cast<Code>(MessageError::not_a_message),
                       "'method' is missing or is not a string");
  if (!message.contains("id")) return std::nullopt;
  if (!is_id) return error_reply(MessageError::not_a_message, "'id' is neither a string nor an integer");
  const Json params = message.contains("params") ? message["params"] : Json::object();
  if (!params.is_object()) return error_reply(id, invalid_params, "'params' is not an object");
  const auto reply = [&](Json result) {
    return Json{{"jsonrpc", "2.0"}, {"id", id}, {"result", std::move(result)}};
  };
  try {
    if (message["method"] == "tools/list") return reply({{"tools", tools(allow_edits_)}});
    if (const EditAction* edit = called_edit(message, params); edit != nullptr && allow_edits_)
      return reply(call_edit(*edit, params));
    if (allow_edits_ && message["method"] == "tools/call" && params.value("name", Json()) == kEditList)
      return reply(list_edits(params));
    const auto method = methods().find(message["method"].get<std::string>());
    if (method == methods().end()) return error_reply(id, unknown_method, "this server has no such method");
    const Store store = Store::open_read(memory());
    Json result = method->second(store, params);
    if (method->first == "initialize")
      result["serverInfo"] = {{"name", "loci-memory"}, {"version", version_}};
    return reply(std::move(result));
  } catch (const ProtocolError& error) {
    return error_reply(id, error.code, error.text);
  } catch (const Error& error) {
    return error_reply(id, internal_error, error.what());
  }
}

}  // namespace loci::memory

#include "memory/server/tool_server.h"

#include <gmock/gmock.h>

#include <fstream>

#include "mapping/base/files.h"
#include "mapping/base/text/json.h"
#include "memory/edits/edit_actions.h"
#include "memory/questions/question.h"
#include "memory/questions/replies/reply.h"
#include "memory/sentences/natural_language.h"
#include "tests/memory/questions/day_fixture.h"

namespace loci::memory {
namespace {

using ::testing::HasSubstr;

class ToolServerTest : public testing_support::DayFixture {
 protected:
  std::string raw(const std::string& message) const {
    const ToolServer server(file_, "1.2.3");
    return LineTransport(server).reply(message).value_or("");
  }
  Json reply(const std::string& method, const Json& params = Json::object()) const {
    const std::string text =
        raw(Json{{"jsonrpc", "2.0"}, {"id", 7}, {"method", method}, {"params", params}}.dump());
    EXPECT_EQ(text.find('\n'), std::string::npos);
    Json json = parse_json(text, "reply");
    EXPECT_EQ(json["id"], 7);
    return json;
  }
  Json call(const std::string& tool, const Json& arguments) const {
    return reply("tools/call", {{"name", tool}, {"arguments", arguments}})["result"];
  }
};

TEST_F(ToolServerTest, AgreesOnAVersionAndSaysWhatItIs) {
  const Json old = reply("initialize", {{"protocolVersion", "2024-11-05"}})["result"];
  EXPECT_EQ(old["protocolVersion"], "2024-11-05");
  EXPECT_EQ(old["serverInfo"]["version"], "1.2.3");
  EXPECT_THAT(old["instructions"].get<std::string>(), HasSubstr("The memory ends at"));
  EXPECT_EQ(reply("initialize", {{"protocolVersion", "2999-01-01"}})["result"]["protocolVersion"],
            "2025-11-25");
  EXPECT_EQ(raw(R"({"jsonrpc": "2.0", "method": "notifications/initialized"})"), "") << "no reply is wanted";
}

TEST_F(ToolServerTest, EveryQuestionIsAToolWithASchema) {
  const Json tools = reply("tools/list")["result"]["tools"];
  ASSERT_EQ(tools.size(), questions().size() + 1);
  for (const Json& tool : tools) {
    EXPECT_EQ(tool["inputSchema"]["type"], "object");
    EXPECT_EQ(tool["annotations"]["readOnlyHint"], true);
    for (const Json& name : tool["inputSchema"]["required"])
      EXPECT_TRUE(tool["inputSchema"]["properties"].contains(name.get<std::string>())) << tool;
  }
}

TEST_F(ToolServerTest, ToolsAnswerAsTheQuestionsDo) {
  const Json result = call("where", {{"object", "object_1"}, {"at", "09:00"}});
  EXPECT_EQ(result["isError"], false);
  const Query query{.question = "where", .arguments = {{"object", "object_1"}, {"at", "09:00"}}};
  const Answer answer = ask(*store_, query);
  const Reply reply = find_question("where")->reply(*store_, query, answer);
  EXPECT_FALSE(reply.text.empty());
  EXPECT_EQ(result["structuredContent"], full_json(reply, answer));
  EXPECT_EQ(result["structuredContent"]["reply"]["text"], reply.text);
  EXPECT_EQ(result["content"][0]["text"], full_text(reply, answer, TimeWriter(*store_)));
  EXPECT_THAT(result["content"][0]["text"].get<std::string>(), testing::StartsWith(reply.text));
}

TEST_F(ToolServerTest, AMistakeOfTheModelIsAResultItCanLearnFrom) {
  for (const auto& [tool, arguments] :
       std::vector<std::pair<std::string, Json>>{{"where", {{"object", "zebra"}}},
                                                 {"where", Json::object()},
                                                 {"where", {{"object", Json::array()}}},
                                                 {"where", {{"object", "object_1"}, {"colour", "red"}}},
                                                 {"like", {{"image", "/etc/passwd"}}},
                                                 {"ask", {{"question", "Fribble the gromp?"}}}}) {
    const Json result = call(tool, arguments);
    EXPECT_EQ(result["isError"], true) << tool << arguments;
    EXPECT_FALSE(result["content"][0]["text"].get<std::string>().empty());
  }
}

TEST_F(ToolServerTest, ASentenceIsAskedAtATimeAndAfterOthers) {
  const auto data = [&](const Json& arguments) { return call("ask", arguments)["structuredContent"]; };
  const auto sentences = [&](const NaturalLanguageQuestion& question) {
    return to_json(ask(*store_, question).back());
  };
  EXPECT_EQ(data({{"question", "Where is object_1?"}, {"at", "09:00"}}),
            sentences({{"Where is object_1?"}, read_as_of(*store_, "09:00", "")}));
  EXPECT_EQ(data({{"question", "And object_2?"}, {"before", {"Where is object_1?"}}}),
            sentences({{"Where is object_1?", "And object_2?"}}));
  for (const Json& wrong :
       {Json{{"bogus", 1}}, Json{{"before", "Where is object_1?"}}, Json{{"at", "tea"}}}) {
    Json arguments = {{"question", "Where is object_1?"}};
    arguments.update(wrong);
    EXPECT_EQ(call("ask", arguments)["isError"], true) << wrong;
  }
}

TEST_F(ToolServerTest, AMisspeltArgumentIsNamed) {
  const auto said = [&](const std::string& tool, const Json& arguments) {
    return call(tool, arguments)["content"][0]["text"].get<std::string>();
  };
  EXPECT_EQ(said("where", {{"obect", "mug"}}), "'where' does not take 'obect'; did you mean 'object'?");
  EXPECT_EQ(said("where", {{"thing", "mug"}}),
            "'where' does not take 'thing'; it takes object, at, known-at");
  EXPECT_THAT(said("where", Json::object()), testing::StartsWith("'where' needs 'object' ("));
}

TEST_F(ToolServerTest, APointMayBeAListOfNumbers) {
  const Json result = call("near", {{"around", {1.5, 2, 0.9}}});
  EXPECT_EQ(result["isError"], false) << result;
  EXPECT_EQ(result, call("near", {{"around", "1.5,2,0.9"}}));
}

TEST_F(ToolServerTest, ObjectsAndPlacesAreResources) {
  const Json resources = reply("resources/list")["result"]["resources"];
  bool has_object = false, has_place = false;
  for (const Json& resource : resources) {
    const std::string uri = resource["uri"];
    has_object |= uri.starts_with("loci://object/");
    has_place |= uri.starts_with("loci://place/");
    const Json contents = reply("resources/read", {{"uri", uri}})["result"]["contents"];
    EXPECT_EQ(contents[0]["uri"], uri);
    EXPECT_TRUE(parse_json(contents[0]["text"].get<std::string>(), uri).is_object());
  }
  EXPECT_TRUE(has_object && has_place) << resources;
  for (const char* uri : {"loci://object/zebra", "loci://scene/999999/image", "loci://scene/x/image",
                          "file:///etc/passwd", "loci://object/../../etc/passwd"})
    EXPECT_EQ(reply("resources/read", {{"uri", uri}})["error"]["code"], -32002) << uri;
}

TEST_F(ToolServerTest, MalformedMessagesGetErrors) {
  const auto code = [&](const std::string& message) {
    return parse_json(raw(message), "reply")["error"]["code"];
  };
  EXPECT_EQ(code("{"), -32700);
  EXPECT_EQ(code(std::string(100000, '[')), -32700);
  EXPECT_EQ(code("[]"), -32600);
  EXPECT_EQ(code(R"({"jsonrpc": "1.0", "id": 1, "method": "ping"})"), -32600);
  EXPECT_EQ(code(R"({"jsonrpc": "2.0", "id": {}, "method": "ping"})"), -32600);
  EXPECT_EQ(parse_json(raw(R"({"jsonrpc": "2.0", "id": 7})"), "reply")["id"], 7);
  EXPECT_EQ(code(R"({"jsonrpc": "2.0", "id": 1, "method": 5})"), -32600);
  EXPECT_EQ(code(R"({"jsonrpc": "2.0", "method": 5})"), -32600);
  EXPECT_EQ(code(R"({"jsonrpc": "2.0"})"), -32600);
  EXPECT_EQ(code(R"({"jsonrpc": "2.0", "id": 1})"), -32600);
  EXPECT_EQ(raw(R"({"jsonrpc": "2.0", "id": 1, "result": {}})"), "") << "a reply";
  EXPECT_EQ(code(R"({"jsonrpc": "2.0", "id": 1, "method": "tools/delete"})"), -32601);
  EXPECT_EQ(code(R"({"jsonrpc": "2.0", "id": 1, "method": "tools/call", "params": []})"), -32602);
  EXPECT_EQ(code(R"({"jsonrpc": "2.0", "id": 1, "method": "tools/call", "params": {"name": "erase"}})"),
            -32602);
  EXPECT_EQ(code(R"({"jsonrpc": "2.0", "id": 1, "method": "resources/list", "params": {"cursor": "-1"}})"),
            -32602);
}

TEST_F(ToolServerTest, BatchesEndWithTheRevisionThatHasNone) {
  const ToolServer server(file_, "1.2.3");
  const std::string ping = R"({"jsonrpc": "2.0", "id": 1, "method": "ping"})", batch = "[" + ping + "]";
  for (const auto& [version, taken] : {std::pair("2025-03-26", true), {"2025-06-18", false}}) {
    LineTransport transport(server);
    const Json begin = {
        {"jsonrpc", "2.0"}, {"id", 1}, {"method", "initialize"}, {"params", {{"protocolVersion", version}}}};
    transport.reply(begin.dump());
    EXPECT_EQ(parse_json(transport.reply(batch).value_or(""), "reply").is_array(), taken) << version;
    EXPECT_TRUE(parse_json(transport.reply(ping).value_or(""), "reply").contains("result")) << version;
  }
}

TEST_F(ToolServerTest, EditsAreToolsWhenTheyAreAllowed) {
  store_.reset();
  const ToolServer server(file_, "1.2.3", true);
  const auto call = [&](const std::string& method, const Json& params) {
    const Json message = {{"jsonrpc", "2.0"}, {"id", 7}, {"method", method}, {"params", params}};
    return server.answer(message).value_or(Json())["result"];
  };
  const Json tools = call("tools/list", Json::object())["tools"];
  EXPECT_EQ(tools.size(), questions().size() + 1 + edit_actions().size() + 1);
  EXPECT_EQ(tools.back()["name"], "edit-list");
  EXPECT_EQ(tools.back()["annotations"]["readOnlyHint"], true);
  EXPECT_EQ(tools[tools.size() - 2]["name"], "edit-redo");
  EXPECT_EQ(tools[tools.size() - 2]["annotations"]["readOnlyHint"], false);
  const Json said = call(
      "tools/call",
      {{"name", "edit-say"}, {"arguments", {{"about", "table_1"}, {"key", "alias"}, {"value", "bench 7"}}}});
  EXPECT_EQ(said["isError"], false);
  EXPECT_THAT(said["structuredContent"]["edit"].get<std::string>(), HasSubstr("bench 7"));
  EXPECT_EQ(call("tools/call", {{"name", "on"}, {"arguments", {{"place", "bench 7"}}}})["isError"], false);
  const Json place = call("resources/read", {{"uri", "loci://place/bench%207"}});
  EXPECT_EQ(place["contents"][0]["uri"], "loci://place/bench%207");
  EXPECT_THAT(call("tools/call", {{"name", "edit-list"}})["content"][0]["text"].get<std::string>(),
              HasSubstr("bench 7"));
  const Json undone = call("tools/call", {{"name", "edit-undo"}});
  EXPECT_EQ(undone["isError"], false);
  EXPECT_THAT(undone["content"][0]["text"].get<std::string>(), testing::StartsWith("Undone: "));
  EXPECT_THAT(undone["structuredContent"]["reply"]["text"].get<std::string>(), HasSubstr("Undone: "));
  EXPECT_EQ(call("tools/call", {{"name", "on"}, {"arguments", {{"place", "bench 7"}}}})["isError"], true);
  EXPECT_EQ(call("tools/call", {{"name", "edit-merge"}, {"arguments", {{"one", "object_1"}}}})["isError"],
            true);
}

TEST_F(ToolServerTest, EditsAreRefusedWhenTheyAreNot) {
  const std::string before = read_file(file_);
  const Json refused = reply("tools/call", {{"name", "edit-undo"}});
  EXPECT_EQ(refused["error"]["code"], -32602);
  EXPECT_EQ(read_file(file_), before);
}

TEST_F(ToolServerTest, NothingIsWritten) {
  const std::string before = read_file(file_);
  for (const char* tool : {"objects", "on", "changes", "missing"}) call(tool, {{"place", "table_1"}});
  EXPECT_EQ(read_file(file_), before);
}

}  // namespace
}  // namespace loci::memory

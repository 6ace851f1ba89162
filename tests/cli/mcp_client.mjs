// The protocol's own client library talks to `loci-memory serve --mcp`: what it makes of the replies, as JSON. It
// checks every message and result against the types of the protocol.
//   node mcp_client.mjs stdio PROGRAM MEMORY
//   node mcp_client.mjs http URL TOKEN
import { Client } from "@modelcontextprotocol/sdk/client/index.js";
import { StdioClientTransport } from "@modelcontextprotocol/sdk/client/stdio.js";
import { StreamableHTTPClientTransport } from "@modelcontextprotocol/sdk/client/streamableHttp.js";

const [kind, target, last] = process.argv.slice(2);
const http = (token) =>
  new StreamableHTTPClientTransport(new URL(target), { requestInit: { headers: { Authorization: `Bearer ${token}` } } });
const transport =
  kind === "http" ? http(last) : new StdioClientTransport({ command: target, args: ["serve", "--mcp", "-m", last] });
const client = new Client({ name: "test", version: "1" });
await client.connect(transport);
await client.ping();
const { tools } = await client.listTools();
const known = await client.callTool({ name: "where", arguments: { object: "object_1" } });
const unknown = await client.callTool({ name: "where", arguments: { object: "zebra" } });
const asked = await client.callTool({ name: "ask", arguments: { question: "Where is object_1?" } });
const { resources } = await client.listResources();
const { resourceTemplates } = await client.listResourceTemplates();
const read = await client.readResource({ uri: "loci://object/object_1" });
const refused = await client.readResource({ uri: "loci://object/zebra" }).catch((error) => error.code);
const facts = {
  server: client.getServerVersion().name,
  tools: tools.map((tool) => tool.name),
  place: known.structuredContent.objects[0].place,
  unknown: unknown.isError,
  asked: asked.content[0].text,
  resources: resources.map((resource) => resource.uri),
  templates: resourceTemplates.length,
  about: JSON.parse(read.contents[0].text).about,
  refused,
};
if (kind === "http") {
  facts.version = transport.protocolVersion;
  facts.session = transport.sessionId.length;
  const answers = await Promise.all(
    Array.from({ length: 20 }, () => client.callTool({ name: "where", arguments: { object: "object_1" } })));
  facts.together = answers.every((answer) => answer.content[0].text === known.content[0].text);
  const stranger = new Client({ name: "stranger", version: "1" });
  facts.stranger = await stranger.connect(http("0123456789abcdee")).catch((error) => error.code);
  await transport.terminateSession();
  facts.ended = transport.sessionId === undefined;
}
console.log(JSON.stringify(facts));
await client.close();

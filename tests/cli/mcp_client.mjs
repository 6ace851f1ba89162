// The protocol's own client library talks to `loci-memory serve --mcp`: what it makes of the replies, as JSON.
import { Client } from "@modelcontextprotocol/sdk/client/index.js";
import { StdioClientTransport } from "@modelcontextprotocol/sdk/client/stdio.js";

const [program, memory] = process.argv.slice(2);
const client = new Client({ name: "test", version: "1" });
await client.connect(new StdioClientTransport({ command: program, args: ["serve", "--mcp", "-m", memory] }));
const { tools } = await client.listTools();
const known = await client.callTool({ name: "where", arguments: { object: "object_1" } });
const unknown = await client.callTool({ name: "where", arguments: { object: "zebra" } });
const asked = await client.callTool({ name: "ask", arguments: { question: "Where is object_1?" } });
const { resources } = await client.listResources();
const { resourceTemplates } = await client.listResourceTemplates();
const read = await client.readResource({ uri: "loci://object/object_1" });
console.log(JSON.stringify({
  server: client.getServerVersion().name,
  tools: tools.map((tool) => tool.name),
  place: known.structuredContent.objects[0].place,
  unknown: unknown.isError,
  asked: asked.content[0].text,
  resources: resources.map((resource) => resource.uri),
  templates: resourceTemplates.length,
  about: JSON.parse(read.contents[0].text).about,
}));
await client.close();

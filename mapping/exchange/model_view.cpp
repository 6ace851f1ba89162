#include "mapping/exchange/model_view.h"

#include <fmt/format.h>

#include "mapping/base/text/base64.h"
#include "mapping/base/text/html.h"

namespace loci::mapping {
namespace {

/// Draws what glb_bytes() writes for a world: nodes, triangles, colours, textures, and animations by a
/// slider.
constexpr const char* kViewer = R"js(
(async () => {
  const canvas = document.getElementById('model-view'), slider = document.getElementById('model-open');
  const gl = canvas.getContext('webgl2');
  if (!gl) return canvas.parentElement.remove();
  const text = document.getElementById('model-glb').href.split(',')[1];
  const bytes = Uint8Array.from(atob(text), c => c.charCodeAt(0));
  const head = new DataView(bytes.buffer).getUint32(12, true);
  const gltf = JSON.parse(new TextDecoder().decode(bytes.subarray(20, 20 + head)));
  const part = i => {
    const view = gltf.bufferViews[i], from = 28 + head + (view.byteOffset || 0);
    return bytes.slice(from, from + view.byteLength);
  };
  const array = i => {
    const a = gltf.accessors[i], data = part(a.bufferView).buffer;
    return a.componentType == 5125 ? new Uint32Array(data) : new Float32Array(data);
  };
  const shader = (type, source) => {
    const s = gl.createShader(type);
    gl.shaderSource(s, '#version 300 es\nprecision highp float;' + source);
    gl.compileShader(s);
    gl.attachShader(program, s);
  };
  const program = gl.createProgram();
  shader(gl.VERTEX_SHADER, `layout(location=0) in vec3 p; layout(location=1) in vec2 t;
    uniform mat4 view, model; out vec3 at; out vec2 uv;
    void main() { vec4 w = model * vec4(p, 1); at = w.xyz; uv = t; gl_Position = view * w; }`);
  shader(gl.FRAGMENT_SHADER, `in vec3 at; in vec2 uv; out vec4 color;
    uniform vec4 base; uniform bool textured; uniform sampler2D image; uniform vec3 eye;
    void main() {
      float lit = 0.6 + 0.4 * abs(dot(normalize(cross(dFdx(at), dFdy(at))), normalize(eye - at)));
      color = textured ? texture(image, uv) : vec4(pow(base.rgb, vec3(1.0 / 2.2)) * lit, 1);
    }`);
  gl.linkProgram(program);
  gl.useProgram(program);
  gl.enable(gl.DEPTH_TEST);
  const uniform = name => gl.getUniformLocation(program, name);
  const buffer = (target, data, location, size) => {
    gl.bindBuffer(target, gl.createBuffer());
    gl.bufferData(target, data, gl.STATIC_DRAW);
    if (size) { gl.enableVertexAttribArray(location); gl.vertexAttribPointer(location, size, gl.FLOAT, false, 0, 0); }
  };
  const textures = await Promise.all((gltf.images || []).map(async image => {
    const bitmap = new Image();
    bitmap.src = URL.createObjectURL(new Blob([part(image.bufferView)], {type: image.mimeType}));
    await new Promise(resolve => bitmap.onload = bitmap.onerror = resolve);
    const texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, gl.RGBA, gl.UNSIGNED_BYTE, bitmap);
    gl.generateMipmap(gl.TEXTURE_2D);
    return texture;
  }));
  const meshes = gltf.meshes.map(mesh => mesh.primitives.map(primitive => {
    const vao = gl.createVertexArray(), material = gltf.materials[primitive.material].pbrMetallicRoughness;
    const positions = gltf.accessors[primitive.attributes.POSITION];
    gl.bindVertexArray(vao);
    buffer(gl.ARRAY_BUFFER, array(primitive.attributes.POSITION), 0, 3);
    if (primitive.attributes.TEXCOORD_0 !== undefined)
      buffer(gl.ARRAY_BUFFER, array(primitive.attributes.TEXCOORD_0), 1, 2);
    buffer(gl.ELEMENT_ARRAY_BUFFER, array(primitive.indices));
    return {vao, count: gltf.accessors[primitive.indices].count, base: material.baseColorFactor || [1, 1, 1, 1],
            texture: material.baseColorTexture && textures[gltf.textures[material.baseColorTexture.index].source],
            middle: positions.min.map((low, i) => (low + positions.max[i]) / 2)};
  }));
  const multiply = (a, b) => a.map((_, i) => {
    let sum = 0;
    for (let k = 0; k < 4; ++k) sum += a[i % 4 + 4 * k] * b[k + 4 * (i >> 2)];
    return sum;
  });
  const pose = ([x, y, z], [a, b, c, w]) => [
    1 - 2 * (b * b + c * c), 2 * (a * b + c * w), 2 * (a * c - b * w), 0,
    2 * (a * b - c * w), 1 - 2 * (a * a + c * c), 2 * (b * c + a * w), 0,
    2 * (a * c + b * w), 2 * (b * c - a * w), 1 - 2 * (a * a + b * b), 0, x, y, z, 1];
  const apply = (m, [x, y, z]) => [0, 1, 2].map(i => m[i] * x + m[4 + i] * y + m[8 + i] * z + m[12 + i]);
  const opened = {};
  for (const {channels, samplers} of gltf.animations || [])
    opened[channels[0].target.node] = [channels[0].target.path, Array.from(array(samplers[0].output))];
  const moved = (node, i) => {
    let at = node.translation || [0, 0, 0], turn = node.rotation || [0, 0, 0, 1];
    const [path, values] = opened[i] || [];
    if (path == 'translation') at = values.slice(3).map(value => value * slider.value);
    if (path == 'rotation') {
      const half = Math.acos(values[7]) * slider.value, sine = Math.sqrt(1 - values[7] ** 2) || 1;
      turn = [...values.slice(4, 7).map(value => value / sine * Math.sin(half)), Math.cos(half)];
    }
    return pose(at, turn);
  };
  const visit = (i, parent, draw) => {
    const node = gltf.nodes[i], world = multiply(parent, moved(node, i));
    if (node.mesh !== undefined) meshes[node.mesh].forEach(mesh => draw(node, world, mesh));
    (node.children || []).forEach(child => visit(child, world, draw));
  };
  const low = [1e9, 1e9, 1e9], high = [-1e9, -1e9, -1e9], root = pose([0, 0, 0], [0, 0, 0, 1]);
  visit(0, root, (node, world, mesh) => apply(world, mesh.middle).forEach((value, i) => {
    low[i] = Math.min(low[i], value);
    high[i] = Math.max(high[i], value);
  }));
  const centre = low.map((value, i) => (value + high[i]) / 2);
  let yaw = 0.5, pitch = 0.6, distance = Math.hypot(...low.map((value, i) => high[i] - value));
  const redraw = () => {
    const out = [Math.sin(yaw) * Math.cos(pitch), Math.sin(pitch), Math.cos(yaw) * Math.cos(pitch)];
    const eye = centre.map((value, i) => value + distance * out[i]);
    const x = [Math.cos(yaw), 0, -Math.sin(yaw)];
    const y = [out[1] * x[2], out[2] * x[0] - out[0] * x[2], -out[1] * x[0]];
    const turn = [0, 1, 2].flatMap(i => [x[i], y[i], out[i], 0]).concat([0, 0, 0, 1]);
    const f = 1.8, near = 0.05, far = 60;
    const lens = [f * canvas.height / canvas.width, 0, 0, 0, 0, f, 0, 0, 0, 0, (far + near) / (near - far), -1, 0, 0,
                  2 * far * near / (near - far), 0];
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(0.94, 0.95, 0.96, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.uniform3fv(uniform('eye'), eye);
    const view = multiply(multiply(lens, turn), pose(eye.map(value => -value), [0, 0, 0, 1]));
    gl.uniformMatrix4fv(uniform('view'), false, view);
    visit(0, root, (node, world, mesh) => {
      const beside = apply(world, mesh.middle).reduce((sum, value, i) => sum + (value - centre[i]) * out[i], 0);
      if (/^(wall|ceiling)/.test(node.name) && beside > 0) return;  // it would hide the furniture
      gl.uniformMatrix4fv(uniform('model'), false, world);
      gl.uniform4fv(uniform('base'), mesh.base);
      gl.uniform1i(uniform('textured'), mesh.texture ? 1 : 0);
      if (mesh.texture) gl.bindTexture(gl.TEXTURE_2D, mesh.texture);
      gl.bindVertexArray(mesh.vao);
      gl.drawElements(gl.TRIANGLES, mesh.count, gl.UNSIGNED_INT, 0);
    });
  };
  slider.oninput = redraw;
  canvas.onpointermove = event => {
    if (!event.buttons) return;
    yaw -= event.movementX / 200;
    pitch = Math.min(1.5, Math.max(-0.2, pitch + event.movementY / 200));
    redraw();
  };
  canvas.onwheel = event => {
    event.preventDefault();
    distance *= Math.exp(event.deltaY / 1000);
    redraw();
  };
  redraw();
})();
)js";

}  // namespace

std::string model_section(const std::string& glb) {
  return html_section(
      "model", "3-D view",
      fmt::format(
          "<div><canvas id=\"model-view\" width=\"1000\" height=\"600\" "
          "style=\"max-width:100%;touch-action:none\">"
          "</canvas><p><label>Closed <input type=\"range\" id=\"model-open\" min=\"0\" max=\"1\" "
          "step=\"0.01\" "
          "value=\"0\"> open</label> <span class=\"faint\">Drag turns, the wheel zooms.</span></p></div>\n"
          "<p><a id=\"model-glb\" download=\"map.glb\" href=\"data:model/gltf-binary;base64,{}\">"
          "Download as glTF (map.glb, {:.1f} MB)</a></p>\n<script>{}</script>\n",
          base64_from_bytes(glb), static_cast<double>(glb.size()) / 1e6, kViewer));
}

}  // namespace loci::mapping

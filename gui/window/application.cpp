#include "gui/window/application.h"

#include <QVTKOpenGLNativeWidget.h>
#include <QBuffer>
#include <QCheckBox>
#include <QOffscreenSurface>
#include <QOpenGLContext>
#include <QOpenGLFunctions>
#include <QSurfaceFormat>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <regex>
#include <vector>

#include "gui/core/background.h"
#include "gui/data/open_memory.h"
#include "gui/scene3d/egl_window.h"
#include "gui/views/compare_view.h"
#include "gui/views/question_bar.h"
#include "gui/window/benchmark.h"
#include "gui/window/main_window.h"
#include "mapping/base/error.h"
#include "mapping/base/files.h"
#include "mapping/exchange/formats/ply.h"

namespace loci::gui {
namespace {

/// Enough for the window to be laid out and painted.
constexpr int kRoundsOfEvents = 5;

QSize parse_size(const std::string& text) {
  std::smatch match;
  if (!std::regex_match(text, match, std::regex(R"((\d{3,5})x(\d{3,5}))")))
    throw Error("--size '" + text + "' is no size in pixels", {}, "write it as 1280x800");
  constexpr int kMaxSide = 8192;  // of what graphics drivers draw
  const QSize size(std::stoi(match[1]), std::stoi(match[2]));
  if (std::max(size.width(), size.height()) > kMaxSide)
    throw Error("--size '" + text + "' is too large", {},
                "images have up to " + std::to_string(kMaxSide) + " pixels a side");
  return size;
}

/// Error where the parts of the window took more room.
void check_size(const MainWindow& window, const QSize& wished) {
  const QSize size = window.size();
  if (size != wished)
    throw Error("--size is too small for the window", {},
                "give " + std::to_string(size.width()) + "x" + std::to_string(size.height()) +
                    " or more, or --view map");
}

/// Images are drawn in memory where that is possible; a screen is the fallback. Error when neither
/// works.
MapBackend image_backend(bool has_screen) {
  try {
    const EglWindow probe(16, 16);
    return MapBackend::memory;
  } catch (const Error&) {
    if (!has_screen) throw;
    return MapBackend::widget;
  }
}

/// How a window draws: by the graphics card, or in memory where there is only software for it. Error when
/// there is no OpenGL: a widget would stay blank.
MapBackend window_backend() {
  QOpenGLContext context;
  if (!context.create())
    throw Error("no OpenGL context can be made on this display", {}, "install libgl1-mesa-dri");
  QOffscreenSurface surface;
  surface.create();
  if (!context.makeCurrent(&surface)) return MapBackend::widget;
  const auto* name = reinterpret_cast<const char*>(context.functions()->glGetString(GL_RENDERER));
  const QString renderer = name == nullptr ? QString() : QString(name).toLower();
  context.doneCurrent();
  if (!renderer.contains("llvmpipe") && !renderer.contains("softpipe") && !renderer.contains("swrast"))
    return MapBackend::widget;
  try {
    const EglWindow probe(16, 16);
    return MapBackend::memory;
  } catch (const Error&) {
    return MapBackend::widget;
  }
}

/// Qt remarks on what a bare machine lacks and nothing here uses; stderr is for our own line.
void pass_message(QtMsgType, const QMessageLogContext&, const QString& message) {
  if (message.startsWith("QStandardPaths: XDG_RUNTIME_DIR") ||
      message.startsWith("This plugin does not support"))
    return;
  std::fprintf(stderr, "%s\n", message.toUtf8().constData());
}

MemoryOpener opener() {
  return [](const std::string& path, Progress& progress) { return OpenMemory::open(path, progress); };
}

/// What the options select.
struct Target {
  std::optional<TimeNs> time = {};
  std::optional<TimeNs> beside = {};  ///< unset = none, or another memory
  SearchResult found = {};
};

Target find_target(const OpenMemory& data, const BrowseOptions& options) {
  Target target;
  if (!options.at.empty()) target.time = data.time_of(options.at);
  if (!options.beside.empty() && !std::filesystem::exists(options.beside)) {
    if (options.beside.ends_with(".loci")) throw Error("no such memory", {options.beside, 0, {}});
    target.beside = data.time_of(options.beside);
  }
  if (options.select.empty() || data.scenes().empty()) return target;
  target.found = data.find(options.select, target.time.value_or(data.scenes().back().time));
  return target;
}

void go_to(MainWindow& window, const Target& target, const BrowseOptions& options) {
  SelectionModel& selection = window.browser().selection();
  if (target.time) selection.set_time(*target.time);
  if (!target.found.objects.empty())
    selection.select_object(target.found.objects.front());
  else if (!target.found.place.empty())
    selection.select_place(target.found.place);
  if (!options.beside.empty()) {
    if (target.beside)
      window.docks().compare().set_other(*target.beside);
    else
      window.docks().compare().compare_with(QString::fromStdString(options.beside));
    window.docks().compare().beside_box()->setChecked(true);
  }
  if (!options.show.empty()) window.docks().show(options.show);
  if (options.ask.empty()) return;
  window.question_bar().open();
  window.question_bar().ask(QString::fromStdString(options.ask));
}

void run_actions(MainWindow& window, const BrowseOptions& options) {
  for (const std::string& action : options.run)
    if (!window.question_bar().run_action(QString::fromStdString(action)))
      throw Error("--run '" + action + "' is no action of the menus", {}, "as \"Depth image\"");
}

MapLayer layer_of(const std::string& name) {
  static const std::map<std::string, MapLayer> kLayers = {
      {"map", MapLayer::map},       {"room", MapLayer::room},      {"objects", MapLayer::objects},
      {"labels", MapLayer::labels}, {"cloud", MapLayer::cloud},    {"camera", MapLayer::camera},
      {"trace", MapLayer::trace},   {"cameras", MapLayer::cameras}};
  const auto found = kLayers.find(name);
  if (found == kLayers.end())
    throw Error("--hide '" + name + "' is no layer", {},
                "layers are map, room, objects, labels, cloud, camera, trace, cameras");
  return found->second;
}

void settle() {
  for (int i = 0; i < kRoundsOfEvents; ++i) {
    QApplication::processEvents();
    finish_background();
  }
}

void write_image(MainWindow& window, const BrowseOptions& options) {
  const std::string& path = options.screenshot;
  if (options.view == "map")
    window.map().setFixedSize(parse_size(options.size));  // the window around it takes the size it needs
  else
    window.resize(parse_size(options.size));
  for (const std::string& name : options.hide) window.map().set_layer(layer_of(name), false);
  window.show();
  settle();
  if (options.view != "map") check_size(window, parse_size(options.size));
  window.map().look_from(MapViewpoint::overview);  // what came first must not decide the view
  run_actions(window, options);                    // a viewpoint is of what is shown
  settle();
  const QImage image = options.view == "map" ? window.map().image() : window.screenshot();
  QByteArray bytes;
  QBuffer buffer(&bytes);
  buffer.open(QIODevice::WriteOnly);
  if (!image.save(&buffer, "PNG")) throw Error("the image could not be encoded", {path, 0, {}});
  write_file_atomically(path, {bytes.constData(), static_cast<size_t>(bytes.size())});
}

void show_room(MainWindow& window, const BrowseOptions& options) {
  if (!options.room.empty()) window.map().set_room(mapping::read_ply_mesh(options.room));
}

int take_image(const BrowseOptions& options, std::shared_ptr<const OpenMemory> data, MapBackend backend) {
  WindowOptions window_options;
  window_options.remember = false;
  window_options.backend = backend;
  const Target target = find_target(*data, options);
  MainWindow window(opener(), window_options);
  window.show_data(std::move(data));
  show_room(window, options);
  go_to(window, target, options);
  write_image(window, options);
  return 0;
}

int measure(TimedApplication& application, const BrowseOptions& options, MapBackend backend) {
  WindowOptions window_options;
  window_options.backend = backend;
  window_options.remember = false;
  MainWindow window(opener(), window_options);
  window.resize(parse_size(options.size));
  options.print(to_text(benchmark_window(application, window, options.file, options.measure_s)));
  return 0;
}

int show_window(const BrowseOptions& options, MapBackend backend) {
  WindowOptions window_options;
  window_options.backend = backend;
  MainWindow window(opener(), window_options);
  show_room(window, options);
  window.show();
  if (!options.file.empty())
    window.open(QString::fromStdString(options.file), [&window, &options] {
      window.browser().reader().read<Target>(
          &window, "target", Urgency::moment,
          [options](const OpenMemory& memory) { return find_target(memory, options); },
          [&window, &options](const Target& target) {
            go_to(window, target, options);
            run_actions(window, options);
          });
    });
  return QApplication::exec();
}

}  // namespace

int run_browser(const BrowseOptions& options, const std::string& program) {
  const bool image = !options.screenshot.empty();
  std::shared_ptr<const OpenMemory> data;
  MapBackend backend = MapBackend::widget;
  if (image) {
    if (options.file.empty()) throw Error("an image needs a memory", {}, "give a FILE.loci");
    parse_size(options.size);
    for (const std::string& name : options.hide) layer_of(name);
    if (options.view != "window" && options.view != "map")
      throw Error("--view '" + options.view + "' is no view", {}, "views are window, map");
    data = OpenMemory::open(options.file);
    backend = image_backend(options.has_screen);
  } else if (!options.has_screen) {
    throw Error("there is no screen (DISPLAY is not set)", {}, "use --screenshot FILE, or xvfb-run");
  }
  QSurfaceFormat format = QVTKOpenGLNativeWidget::defaultFormat();
  format.setSamples(0);
  QSurfaceFormat::setDefaultFormat(format);  // Takes effect only before there is an application.
  qInstallMessageHandler(pass_message);
  std::vector<std::string> words = {program};
  if (backend == MapBackend::memory) words.insert(words.end(), {"-platform", "offscreen"});
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  auto count = static_cast<int>(arguments.size());
  TimedApplication application(count, arguments.data());
  QApplication::setOrganizationName("loci");
  QApplication::setApplicationName(QString::fromStdString(program));
  if (backend == MapBackend::widget) backend = window_backend();
  apply_theme(application, options.theme, options.has_desktop);
  if (options.measure_s > 0) return measure(application, options, backend);
  return image ? take_image(options, std::move(data), backend) : show_window(options, backend);
}

}  // namespace loci::gui

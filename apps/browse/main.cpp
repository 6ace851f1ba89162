// loci-browse: one window onto one memory, or a picture of it.

#include <QVTKOpenGLNativeWidget.h>
#include <CLI/CLI.hpp>
#include <QApplication>
#include <QBuffer>
#include <QOpenGLContext>
#include <QSurfaceFormat>
#include <cstdio>
#include <memory>
#include <optional>
#include <regex>
#include <string>

#include "apps/cli/program.h"
#include "gui/data/memory_data.h"
#include "gui/main_window.h"
#include "gui/scene3d/egl_window.h"
#include "gui/text.h"
#include "gui/theme.h"
#include "mapping/base/files.h"

namespace {

using namespace loci;

constexpr const char* kExamples =
    "Examples:\n"
    "  loci-browse demo-output/memory.loci\n"
    "  loci-browse demo-output/memory.loci --screenshot browser.png --select object_1";

struct Arguments {
  std::string file;
  std::string screenshot;
  std::string at;
  std::string select;
  std::string theme = "system";
  std::string size = "1280x800";
};

void declare(CLI::App& app, Arguments& arguments) {
  app.footer(kExamples);
  app.add_option("FILE", arguments.file, "The memory to open (*.loci)");
  app.add_option("--screenshot", arguments.screenshot,
                 "Write a picture of the window to this PNG file and exit; needs no screen");
  app.add_option("--at", arguments.at,
                 "The time to show: ISO 8601, or a time of the last day (default: the last scene)");
  app.add_option("--select", arguments.select,
                 "The object to choose (object_12, 12, or its name), or a place");
  app.add_option("--theme", arguments.theme, "Colours")
      ->check(CLI::IsMember({"system", "light", "dark"}))
      ->capture_default_str();
  app.add_option("--size", arguments.size, "Size of the picture in pixels")->capture_default_str();
}

QSize parse_size(const std::string& text) {
  std::smatch match;
  if (!std::regex_match(text, match, std::regex(R"((\d{3,5})x(\d{3,5}))")))
    throw Error("--size '" + text + "' is no size in pixels", {}, "write it as 1280x800");
  return {std::stoi(match[1]), std::stoi(match[2])};
}

bool has_screen() {
  return qEnvironmentVariableIsSet("DISPLAY") || qEnvironmentVariableIsSet("WAYLAND_DISPLAY") ||
         qEnvironmentVariableIsSet("QT_QPA_PLATFORM");
}

/// Pictures are drawn in memory where that is possible; a screen is only the second way. Error when neither
/// works.
MapBackend picture_backend() {
  try {
    const EglWindow probe(16, 16);
    qputenv("QT_QPA_PLATFORM", "offscreen");
    return MapBackend::memory;
  } catch (const Error&) {
    if (!has_screen()) throw;
    return MapBackend::widget;
  }
}

/// A widget without an OpenGL context stays blank and says nothing.
void require_opengl() {
  QOpenGLContext context;
  if (!context.create())
    throw Error("no OpenGL context can be made on this display", {}, "install libgl1-mesa-dri");
}

ThemeChoice theme_of(const std::string& name) {
  if (name == "dark") return ThemeChoice::dark;
  return name == "light" ? ThemeChoice::light : ThemeChoice::system;
}

void go_to(MainWindow& window, const Arguments& arguments) {
  const BrowserData& data = *window.browser().data();
  SelectionModel& selection = window.browser().selection();
  if (!arguments.at.empty()) selection.set_time(data.time_of(arguments.at));
  if (arguments.select.empty()) return;
  const FoundThings found = data.find(arguments.select, selection.time());
  if (found.objects.empty())
    selection.select_place(found.place);
  else
    selection.select_object(found.objects.front());
}

void write_picture(MainWindow& window, const Arguments& arguments, const QSize& size) {
  window.resize(size);
  window.show();
  for (int i = 0; i < 5; ++i) QApplication::processEvents();
  const QImage image = window.screenshot();
  QByteArray bytes;
  QBuffer buffer(&bytes);
  buffer.open(QIODevice::WriteOnly);
  if (!image.save(&buffer, "PNG"))
    throw Error("the picture could not be encoded", {arguments.screenshot, 0, {}});
  write_file_atomically(arguments.screenshot, {bytes.constData(), static_cast<size_t>(bytes.size())});
}

/// Qt remarks on what a bare machine lacks and nothing here uses; stderr is for our own line.
void pass_message(QtMsgType, const QMessageLogContext&, const QString& message) {
  if (message.startsWith("QStandardPaths: XDG_RUNTIME_DIR") ||
      message.startsWith("This plugin does not support"))
    return;
  std::fprintf(stderr, "loci-browse: %s\n", message.toUtf8().constData());
}

int browse(const Arguments& arguments, int& argc, char** argv) {
  const bool picture = !arguments.screenshot.empty();
  const QSize size = parse_size(arguments.size);
  std::unique_ptr<BrowserData> data;
  if (picture) {
    if (arguments.file.empty()) throw Error("a picture needs a memory", {}, "give a FILE.loci");
    data = open_memory_data(arguments.file);
  } else if (!has_screen()) {
    throw Error("there is no screen (DISPLAY is not set)", {}, "use --screenshot FILE, or xvfb-run");
  }
  WindowOptions options;
  options.remember = !picture;
  if (picture) options.backend = picture_backend();
  QSurfaceFormat format = QVTKOpenGLNativeWidget::defaultFormat();
  format.setSamples(0);
  QSurfaceFormat::setDefaultFormat(format);
  qInstallMessageHandler(pass_message);
  QApplication application(argc, argv);
  QApplication::setOrganizationName("loci");
  QApplication::setApplicationName("loci-browse");
  if (options.backend == MapBackend::widget) require_opengl();
  apply_theme(application, theme_of(arguments.theme));
  MainWindow window(open_memory_data, options);
  if (picture) {
    window.show_data(std::move(data));
    go_to(window, arguments);
    write_picture(window, arguments, size);
    return 0;
  }
  window.show();
  if (!arguments.file.empty() && window.open(QString::fromStdString(arguments.file)))
    go_to(window, arguments);
  return QApplication::exec();
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Looks through the memory of a room.", "loci-browse");
  Arguments arguments;
  declare(app, arguments);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const int code = app.exit(error);
    return code == 0 ? 0 : 2;
  }
  return loci::run_guarded("loci-browse", [&] { return browse(arguments, argc, argv); });
}

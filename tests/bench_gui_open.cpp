// SPDX-License-Identifier: Apache-2.0
// From "open" to light on the screen: the window's times beside those of the same bake without a window, in one run.
// Both bake at the priority the window gives its bake threads, so that what else the machine does hits both.
// Run: xvfb-run -a -s "-screen 0 1280x1024x24" bench_gui_open [SCENE.glb ...]
#include "core/octree/octree_solver.h"
#include "core/scene/gltf_reader.h"
#include "widgets/gl/gl_probe.h"
#include "widgets/main_window.h"
#include "widgets/snapshot_bar.h"
#include "widgets/viewport.h"
#include <QApplication>
#include <QDir>
#include <QElapsedTimer>
#include <QEventLoop>
#include <QTimer>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <map>
#include <sstream>
#include <sys/resource.h>
#include <thread>
#include <unistd.h>

using namespace lightloom;

namespace {

/// Seconds, by the name of what was reached: "read", "rough", "d4", ...
using Times = std::map<std::string, double>;

constexpr int kBakeNice = 10;

/// Processor seconds of this process so far, by what threads are for.
struct Cpu {
    double bake = 0, rest = 0;
};

Cpu cpuNow()
{
    Cpu cpu;
    for (const auto& task : std::filesystem::directory_iterator("/proc/self/task")) {
        std::ifstream file(task.path() / "stat");
        std::string line;
        std::getline(file, line);
        std::istringstream fields(line.substr(line.rfind(')') + 1)); // from field 3, the state
        std::vector<std::string> f{std::istream_iterator<std::string>(fields), {}};
        if (f.size() < 17) continue; // it ended
        const double seconds = (std::stod(f[11]) + std::stod(f[12])) / static_cast<double>(sysconf(_SC_CLK_TCK));
        (std::stoi(f[16]) == kBakeNice ? cpu.bake : cpu.rest) += seconds;
    }
    return cpu;
}

std::string nameOf(const Snapshot& s) { return s.isRough ? "rough" : fmt::format("d{}", s.level); }

Times withoutWindow(const QString& file)
{
    setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), kBakeNice);
    Times times;
    QElapsedTimer clock;
    clock.start();
    const auto now = [&] { return static_cast<double>(clock.nsecsElapsed()) * 1e-9; };
    const auto scene = readScene(file.toStdString());
    if (!scene) return times;
    times["read"] = now();
    Workers workers;
    BakeProducts products;
    BakeControl control(workers, {[&](Snapshot s) { times[nameOf(s)] = now(); }, {}});
    BakeJob job;
    job.scene = *scene;
    job.roughFirst = true;
    OctreeSolver solver;
    (void)solver.bake(job, products, control);
    return times;
}

struct Opening {
    Times times;
    int frames = 0;      ///< until the bake was done
    double drawing = 0;  ///< seconds spent in them
    Cpu cpu;             ///< from opening until the bake was done
    double settled = -1; ///< smooth picture at full resolution
};

Opening inWindow(const QString& file)
{
    Opening out;
    MainWindow window(nullptr);
    window.show();
    QEventLoop loop;
    QElapsedTimer clock;
    const auto now = [&] { return static_cast<double>(clock.nsecsElapsed()) * 1e-9; };
    std::string awaited; // light that was handed over and is not drawn yet
    QObject::connect(&window, &MainWindow::sceneOpened, &loop, [&] { out.times["read"] = now(); });
    QObject::connect(&window, &MainWindow::lightShown, &loop,
                     [&] { awaited = nameOf(window.snapshots().shown()->snapshot); });
    Cpu before;
    QObject::connect(&window, &MainWindow::bakeEnded, &loop, [&] {
        out.times["done"] = now();
        const Cpu cpu = cpuNow();
        out.cpu = {cpu.bake - before.bake, cpu.rest - before.rest};
    });
    QObject::connect(window.viewport(), &Viewport::frameDrawn, &loop, [&](double ms, bool) {
        out.times.try_emplace("drawn", now());
        if (!awaited.empty()) out.times[std::exchange(awaited, {})] = now();
        if (out.times.contains("done")) return;
        ++out.frames;
        out.drawing += ms * 1e-3;
    });
    QObject::connect(window.viewport(), &Viewport::settled, &loop, [&] {
        if (out.times.contains("done")) out.settled = now(), loop.quit();
    });
    QTimer::singleShot(500, &loop, [&] { // the empty window has been shown
        before = cpuNow();
        clock.start();
        window.openScene(file);
    });
    QTimer::singleShot(120'000, &loop, &QEventLoop::quit);
    loop.exec();
    return out;
}

} // namespace

int main(int argc, char** argv)
{
    setDefaultGlFormat();
    QApplication application(argc, argv);
    QStringList files = QApplication::arguments().mid(1);
    if (files.isEmpty()) {
        const QDir folder(LIGHTLOOM_SOURCE_DIR "/sample_scenes");
        for (const QFileInfo& info : folder.entryInfoList({"*.glb"}, QDir::Files)) files += info.filePath();
    }
    for (const QString& file : files) {
        fmt::print("{}\n", QFileInfo(file).completeBaseName().toStdString());
        Times alone;
        std::thread([&] { alone = withoutWindow(file); }).join(); // its priority goes with it
        const Opening window = inWindow(file);
        for (const char* name : {"read", "drawn", "rough", "d4", "d5", "d6", "done"}) {
            const auto a = alone.find(name);
            const auto w = window.times.find(name);
            if (w == window.times.end()) continue;
            fmt::print("{:6} {:6.2f} s", name, w->second);
            if (a != alone.end()) fmt::print("   alone {:6.2f} s  {:5.2f} x", a->second, w->second / a->second);
            fmt::print("\n");
        }
        fmt::print("smooth {:6.2f} s; until done {} pictures in {:.2f} s; CPU: bake {:.2f} s, rest {:.2f} s\n",
                   window.settled, window.frames, window.drawing, window.cpu.bake, window.cpu.rest);
        std::fflush(stdout);
    }
    return 0;
}

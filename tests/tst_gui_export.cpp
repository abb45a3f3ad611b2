// SPDX-License-Identifier: Apache-2.0
// Claim: File > Export writes what the window shows, in its lamps' state, while the window goes on answering; it says
// what it would replace, can be cancelled, and then leaves no file. What is not finished says so, in the dialog and in
// every file, with the parameters that it was really made with.
#include "core/base/image_file.h"
#include "core/scene/gltf_reader.h"
#include "widgets/export_dialog.h"
#include "widgets/gl/gl_probe.h"
#include "widgets/scene_dock.h"
#include "widgets/snapshot_bar.h"
#include "window_helpers.h"
#include <QApplication>
#include <QCheckBox>
#include <QComboBox>
#include <QDir>
#include <QElapsedTimer>
#include <QFile>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <QSlider>
#include <QTimer>
#include <QToolButton>
#include <map>

using namespace lightloom;
using namespace lightloom::test;

namespace {

/// A window on a baked scene with its export dialog open.
struct Desk {
    Desk() : scene("cornell"), window(makeWindow())
    {
        isBaked = openAndBake(*window, scene.file());
        actionNamed(*window, "Export")->trigger();
        dialog = &window->exportDialog();
        set("out/light");
        QDir().mkpath(scene.path("out"));
        set("out/light"); // its folder is there now
    }
    template<class T>
    T* find(const char* name) const
    {
        return dialog->findChild<T*>(QString(name));
    }
    void set(const char* place) const
    {
        auto* edit = find<QLineEdit>("export.place");
        edit->setText(QString());
        QTest::keyClicks(edit, scene.path(place));
    }
    void press(const char* button) const { QTest::mouseClick(find<QPushButton>(button), Qt::LeftButton); }
    [[nodiscard]] QString state() const { return find<QLabel>("export.state")->text(); }
    [[nodiscard]] std::filesystem::path path(const char* name) const { return scene.path(name).toStdString(); }
    /// Presses the button and waits. `silence`: the longest the window did not answer, as part of the time it took (a
    /// frame takes long where the processor draws, but an export in the window's own thread would be silence alone).
    void run()
    {
        QSignalSpy done(dialog, &ExportDialog::exported);
        QElapsedTimer since, whole;
        qint64 longest = 0;
        QTimer beat;
        QObject::connect(&beat, &QTimer::timeout, [&] { longest = std::max(longest, since.restart()); });
        beat.start(5);
        since.start(), whole.start();
        press("export.go");
        isDone = done.wait(kPatience);
        silence = static_cast<double>(longest) / static_cast<double>(std::max<qint64>(1, whole.elapsed()));
    }
    OwnScene scene;
    std::unique_ptr<MainWindow> window;
    ExportDialog* dialog = nullptr;
    bool isBaked = false, isDone = false;
    double silence = 1.0;
};

glm::dvec3 sumOf(const std::filesystem::path& file)
{
    glm::dvec3 sum(0.0);
    const auto read = readExr(file);
    if (!read || !read->find("")) return sum;
    for (const glm::vec3 e : read->find("")->pixels) sum += glm::dvec3(e);
    return sum;
}

} // namespace

class GuiExportTest : public QObject {
    Q_OBJECT

private Q_SLOTS:
    void initTestCase()
    {
        if (const Result<Done> gl = probeGl(); !gl) QSKIP(gl.error().message.c_str());
    }

    void writesWhatIsShown()
    {
        Desk desk;
        QVERIFY(desk.isBaked);
        desk.find<QCheckBox>("export.volume")->setChecked(true);
        QVERIFY2(desk.state().isEmpty(), qPrintable(desk.state()));
        desk.run();
        QVERIFY2(desk.isDone, qPrintable(desk.state()));
        QVERIFY2(desk.silence <= 0.5, qPrintable(QString("no answer for %1 of the time").arg(desk.silence)));
        for (const char* name : {"out/light.exr", "out/light.glb", "out/light.vdb"}) {
            QVERIFY2(QFile::exists(desk.scene.path(name)), name);
        }
        QVERIFY2(desk.state().startsWith("Wrote light.exr, light.glb, light.vdb"), qPrintable(desk.state()));
        QVERIFY(desk.state().contains("1024 x 1024"));
        const auto read = readExr(desk.path("out/light.exr"));
        QVERIFY2(read, read ? "" : read.error().message.c_str());
        bool namesDepth = false, namesPhotons = false;
        for (const auto& [key, value] : read->notes) {
            namesDepth = namesDepth || (key == "lightloom.octree.depth" && value == "5");
            namesPhotons = namesPhotons || (key == "lightloom.photons" && value == "60000");
        }
        QVERIFY(namesDepth && namesPhotons);
        QVERIFY(readScene(desk.path("out/light.glb")));

        // dimmed to a quarter: a quarter of the light, and a dimmer lamp in the scene
        const glm::dvec3 full = sumOf(desk.path("out/light.exr"));
        desk.find<QCheckBox>("export.volume")->setChecked(false);
        desk.set("out/light");
        QVERIFY2(desk.state().startsWith("Replaces light.exr, light.glb"), qPrintable(desk.state()));
        const auto* slider = desk.window->sceneDock().findChild<QSlider*>();
        QVERIFY(slider != nullptr);
        const std::uint64_t before = desk.window->snapshots().shown()->lookSerial;
        desk.window->sceneDock().findChild<QSlider*>()->setValue(slider->maximum() / 4);
        QTRY_VERIFY_WITH_TIMEOUT(desk.window->snapshots().shown()->lookSerial > before, kPatience);
        desk.run();
        QVERIFY2(desk.isDone, qPrintable(desk.state()));
        const glm::dvec3 dimmed = sumOf(desk.path("out/light.exr"));
        const auto scene = readScene(desk.path("out/light.glb"));
        QVERIFY(scene);
        const double gain = gainOf(*desk.window);
        QVERIFY2(gain > 0.0 && gain < 1.0, qPrintable(QString::number(gain)));
        QVERIFY2(std::abs(dimmed.y / full.y / gain - 1.0) < 1e-4, qPrintable(QString::number(dimmed.y / full.y)));
        float bright = 0.0f, after = 0.0f;
        for (const Material& m : desk.window->scene()->materials) bright = std::max(bright, m.emission.y);
        const std::shared_ptr<const Scene>& written = *scene;
        for (const Instance& instance : written->instances) {
            if (instance.group < 0) continue;
            const Mesh& mesh = written->meshes[std::size_t(instance.mesh)];
            after = written->materials[std::size_t(mesh.material)].emission.y;
        }
        QVERIFY2(std::abs(double(after) / double(bright) / gain - 1.0) < 1e-4,
                 qPrintable(QString::number(after / bright)));
    }

    void cancelLeavesNothing()
    {
        Desk desk;
        QVERIFY(desk.isBaked);
        desk.find<QComboBox>("export.size")->setCurrentText("4096 x 4096 texels");
        desk.find<QCheckBox>("export.direct")->setChecked(true);
        desk.press("export.go");
        QTest::qWait(300);
        QCOMPARE(desk.find<QPushButton>("export.cancel")->text(), QString("Cancel"));
        QElapsedTimer took;
        took.start();
        desk.press("export.cancel");
        QTRY_VERIFY_WITH_TIMEOUT(desk.state().startsWith("Cancelled"), 20'000);
        QVERIFY2(took.elapsed() < 3000, qPrintable(QString::number(took.elapsed())));
        QVERIFY(QDir(desk.scene.path("out")).isEmpty());
        QCOMPARE(desk.find<QPushButton>("export.cancel")->text(), QString("Close"));
        QVERIFY(desk.find<QPushButton>("export.go")->isEnabled());
    }

    void saysWhatWasReallyBaked()
    {
        const OwnScene scene("cornell");
        const auto window = makeWindow();
        BakeParams params = smallBake();
        params.photonCount = 400'000;
        params.octreeDepth = 6;
        window->setParams(params);
        QSignalSpy shown(window.get(), &MainWindow::lightShown), ended(window.get(), &MainWindow::bakeEnded);
        window->openScene(scene.file());
        QVERIFY(shown.wait(kPatience));
        QTest::keyClick(window->viewport(), Qt::Key_Space);
        QVERIFY(window->isPaused());
        window->snapshots().findChildren<QToolButton*>().first()->click();
        QVERIFY(window->snapshots().shown()->snapshot.isRough);
        actionNamed(*window, "Export")->trigger();
        ExportDialog& dialog = window->exportDialog();
        const auto* light = dialog.findChild<QLabel*>("export.light");
        QVERIFY2(light->text().contains("25000 photons") && light->text().contains("depth 4 of 6"),
                 qPrintable(light->text()));
        dialog.findChild<QLineEdit*>("export.place")->setText(scene.path("rough"));
        dialog.findChild<QComboBox*>("export.size")->setCurrentIndex(0);
        dialog.findChild<QCheckBox*>("export.volume")->setChecked(true);
        QSignalSpy done(&dialog, &ExportDialog::exported);
        QTest::mouseClick(dialog.findChild<QPushButton*>("export.go"), Qt::LeftButton);
        QVERIFY(done.wait(kPatience));
        const auto read = readExr(scene.path("rough.exr").toStdString());
        QVERIFY2(read, read ? "" : read.error().message.c_str());
        std::map<std::string, std::string> notes(read->notes.begin(), read->notes.end());
        QCOMPARE(notes["lightloom.photons"], "25000");
        QCOMPARE(notes["lightloom.gather.count"], "25");
        QCOMPARE(notes["lightloom.octree.depth"], "4");
        QCOMPARE(notes["lightloom.octree.detail"], "0");
        QVERIFY2(notes["lightloom.incomplete"].starts_with("rough: 25000 photons"),
                 notes["lightloom.incomplete"].c_str());
        for (const char* name : {"rough.glb", "rough.vdb"}) {
            QFile file(scene.path(name));
            QVERIFY(file.open(QIODevice::ReadOnly));
            const QByteArray bytes = file.readAll();
            QVERIFY2(bytes.contains("incomplete") && bytes.contains("rough: 25000 photons"), name);
        }

        window->snapshots().findChildren<QToolButton*>().last()->click(); // follow the bake
        actionNamed(*window, "Pause")->trigger();
        QVERIFY(ended.wait(kPatience));
        QTRY_COMPARE_WITH_TIMEOUT(light->text(), QString("Depth 6, finished"), kPatience);
    }

    void saysWhatCannotBe()
    {
        Desk desk;
        desk.set("nowhere/light");
        QVERIFY2(desk.state().startsWith("There is no folder"), qPrintable(desk.state()));
        QVERIFY(!desk.find<QPushButton>("export.go")->isEnabled());
        desk.set("out/light");
        for (const char* name : {"export.gltf", "export.lightmap"}) desk.find<QCheckBox>(name)->setChecked(false);
        QVERIFY(!desk.find<QPushButton>("export.go")->isEnabled());
        desk.find<QCheckBox>("export.lightmap")->setChecked(true);
        desk.find<QCheckBox>("export.sceneUv")->setChecked(true);
        desk.press("export.go");
        QTRY_VERIFY_WITH_TIMEOUT(desk.state().contains("no second UV set"), kPatience);
    }

private:
    static double gainOf(const MainWindow& window) { return double(window.sceneDock().mix().front().y); }
};

int main(int argc, char** argv)
{
    setDefaultGlFormat();
    QApplication application(argc, argv);
    GuiExportTest test;
    return QTest::qExec(&test, argc, argv);
}
#include "tst_gui_export.moc"

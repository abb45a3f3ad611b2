// SPDX-License-Identifier: Apache-2.0
// Claim: includes point to the left only (docs/architecture.md): base < params < scene < ... < compare inside core;
// core knows no Qt and no OpenGL; widgets know no app; heavy headers stay out of ours.
#include <QDirIterator>
#include <QRegularExpression>
#include <QtTest>
#include <map>

class LayersTest : public QObject {
    Q_OBJECT

    static QStringList sources(const QString& folder)
    {
        QStringList found;
        QDirIterator files(QStringLiteral(LIGHTLOOM_SOURCE_DIR "/") + folder, {"*.h", "*.cpp", "*.glsl"}, QDir::Files,
                           QDirIterator::Subdirectories);
        while (files.hasNext()) found += files.next();
        return found;
    }

    static QStringList includes(const QString& path)
    {
        QFile file(path);
        if (!file.open(QIODevice::ReadOnly)) return {};
        const QString text = QString::fromUtf8(file.readAll());
        static const QRegularExpression include("^\\s*#\\s*include\\s*[<\"]([^>\"]+)[>\"]",
                                                QRegularExpression::MultilineOption);
        QStringList found;
        for (auto match = include.globalMatch(text); match.hasNext();) found += match.next().captured(1);
        return found;
    }

    static QString relative(const QString& path) { return QDir(LIGHTLOOM_SOURCE_DIR).relativeFilePath(path); }

private Q_SLOTS:
    void coreIncludesPointLeft()
    {
        const std::map<QString, int> rank{{"base", 0},  {"params", 1},    {"scene", 2},     {"trace", 3},
                                          {"field", 4}, {"photonmap", 5}, {"transport", 6}, {"lightcuts", 7},
                                          {"ivg", 8},   {"octree", 8},    {"voxel", 9},     {"atlas", 8},
                                          {"bake", 10}, {"compare", 11}};
        const QStringList files = sources("core");
        QVERIFY2(files.size() > 20, "the source folder was not found");
        for (const QString& path : files) {
            const QString room = relative(path).section('/', 1, 1);
            QVERIFY2(rank.count(room), qPrintable("no layer for " + relative(path)));
            for (const QString& included : includes(path)) {
                if (included.startsWith("shaders/")) continue;
                QVERIFY2(!included.startsWith("widgets/") && !included.startsWith("app/") &&
                             !included.startsWith("tests/"),
                         qPrintable(relative(path) + " includes " + included));
                if (!included.startsWith("core/")) continue;
                const QString other = included.section('/', 1, 1);
                QVERIFY2(rank.count(other), qPrintable("no layer for " + included));
                const bool fine = other == room || rank.at(other) < rank.at(room);
                QVERIFY2(fine, qPrintable(relative(path) + " includes " + included));
            }
        }
    }

    void coreKnowsNoQtAndNoGl()
    {
        static const QRegularExpression foreign("^(Q[A-Z].*|Qt.*|GL/.*|GLES.*|EGL/.*)$");
        for (const QString& path : sources("core") + sources("app/cli")) {
            for (const QString& included : includes(path)) {
                QVERIFY2(!foreign.match(included).hasMatch(), qPrintable(relative(path) + " includes " + included));
            }
        }
    }

    void widgetsKnowNoApp()
    {
        for (const QString& path : sources("widgets")) {
            for (const QString& included : includes(path)) {
                QVERIFY2(!included.startsWith("app/") && !included.startsWith("tests/"),
                         qPrintable(relative(path) + " includes " + included));
            }
        }
    }

    void rawGlLivesInOneRoom()
    {
        static const QRegularExpression call("\\bgl[A-Z][A-Za-z0-9]+\\s*\\(");
        for (const QString& path : sources("widgets") + sources("core") + sources("app")) {
            if (relative(path).startsWith("widgets/gl/")) continue;
            QFile file(path);
            QVERIFY(file.open(QIODevice::ReadOnly));
            const auto match = call.match(QString::fromUtf8(file.readAll()));
            QVERIFY2(!match.hasMatch(), qPrintable(relative(path) + " calls " + match.captured(0)));
        }
    }

    void heavyHeadersStayInSources()
    {
        static const QRegularExpression heavy(
            "^(openvdb/|CLI/|nlohmann/json\\.hpp|tiny_gltf|embree3/|QtWidgets$|QtGui$)");
        for (const QString& path : sources("core") + sources("widgets") + sources("app")) {
            if (!path.endsWith(".h")) continue;
            for (const QString& included : includes(path)) {
                QVERIFY2(!heavy.match(included).hasMatch(), qPrintable(relative(path) + " includes " + included));
            }
        }
    }

    void everySourceNamesItsLicence()
    {
        for (const QString& path :
             sources("core") + sources("widgets") + sources("app") + sources("tests") + sources("shaders")) {
            QFile file(path);
            QVERIFY(file.open(QIODevice::ReadOnly));
            const QString first = QString::fromUtf8(file.readLine());
            const bool gpl = relative(path).startsWith("widgets/") || relative(path) == "app/main.cpp";
            const QString wanted =
                gpl ? "SPDX-License-Identifier: GPL-3.0-or-later" : "SPDX-License-Identifier: Apache-2.0";
            QVERIFY2(first.contains(wanted), qPrintable(relative(path) + " begins: " + first.trimmed()));
        }
    }
};

QTEST_APPLESS_MAIN(LayersTest)
#include "tst_layers.moc"

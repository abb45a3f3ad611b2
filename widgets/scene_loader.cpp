// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/scene_loader.h"
#include "core/scene/gltf_reader.h"
#include <QFile>
#include <filesystem>

namespace lightloom {

SceneLoader::SceneLoader(QObject* parent) : QObject(parent) { pool_.setMaxThreadCount(1); }

SceneLoader::~SceneLoader()
{
    pool_.clear();
    pool_.waitForDone();
}

void SceneLoader::open(const QString& file)
{
    const quint64 serial = ++serial_;
    pool_.clear(); // what waits is older than this
    pool_.start([this, file, serial] {
        const std::filesystem::path path(QFile::encodeName(file).toStdString());
        const Result<std::shared_ptr<const Scene>> scene = readScene(path);
        const std::shared_ptr<const DrawData> data = scene ? makeDrawData(*scene) : nullptr;
        const QString problem = scene ? QString() : QString::fromStdString(scene.error().message);
        QMetaObject::invokeMethod(
            this,
            [this, data, problem, file, serial] {
                if (serial != serial_) return;
                if (data) {
                    Q_EMIT loaded(data, file);
                } else {
                    Q_EMIT failed(problem, file);
                }
            },
            Qt::QueuedConnection);
    });
}

} // namespace lightloom

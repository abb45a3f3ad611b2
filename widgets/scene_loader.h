// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "widgets/gl/draw_data.h"
#include <QObject>
#include <QString>
#include <QThreadPool>

namespace lightloom {

/// Reads scene files on a thread of its own. The newest request wins: results of older ones are dropped.
class SceneLoader final : public QObject {
    Q_OBJECT
public:
    explicit SceneLoader(QObject* parent = nullptr);
    ~SceneLoader() override; ///< waits for a file that is being read
    void open(const QString& file);

Q_SIGNALS:
    void loaded(std::shared_ptr<const lightloom::DrawData> data, QString file);
    void failed(QString message, QString file);

private:
    QThreadPool pool_;
    quint64 serial_ = 0;
};

} // namespace lightloom

// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <QElapsedTimer>
#include <QFile>
#include <QProcess>
#include <QString>
#include <QStringList>
#include <csignal>

/// What tests of the command line share: run the program as others do, and look at what it said.
namespace lightloom::test {

struct Ran {
    int code = -1;
    QString out, err;
    [[nodiscard]] QString text() const { return QString("exit %1\nstdout: %2\nstderr: %3").arg(code).arg(out, err); }
    [[nodiscard]] bool failedWithOneLine() const
    {
        return out.isEmpty() && err.startsWith("error: ") && err.count('\n') == 1 && err.endsWith('\n');
    }
};

inline Ran run(const QStringList& words)
{
    QProcess process;
    process.start(LIGHTLOOM_CLI, words);
    if (!process.waitForFinished(120'000)) {
        process.kill();
        process.waitForFinished();
        return {-2, {}, "took longer than two minutes"};
    }
    const int code = process.exitStatus() == QProcess::NormalExit ? process.exitCode() : -3;
    return {code, QString::fromUtf8(process.readAllStandardOutput()),
            QString::fromUtf8(process.readAllStandardError())};
}

inline QByteArray contents(const QString& path)
{
    QFile file(path);
    return file.open(QIODevice::ReadOnly) ? file.readAll() : QByteArray();
}

inline bool write(const QString& path, const QByteArray& bytes)
{
    QFile file(path);
    return file.open(QIODevice::WriteOnly) && file.write(bytes) == bytes.size();
}

/// Starts, waits for a line of progress on stderr, interrupts, and tells how it ended and how long that took.
inline Ran interrupted(const QStringList& words, qint64& tookMs, int signals = 1)
{
    QProcess process;
    process.start(LIGHTLOOM_CLI, words + QStringList{"--progress", "json"});
    QByteArray err;
    QElapsedTimer waiting;
    waiting.start();
    while (!err.contains("\"progress\"") && waiting.elapsed() < 60'000 && process.state() != QProcess::NotRunning) {
        process.waitForReadyRead(100);
        process.setReadChannel(QProcess::StandardError);
        err += process.readAllStandardError();
    }
    QElapsedTimer timer;
    timer.start();
    for (int i = 0; i < signals; ++i) ::kill(static_cast<pid_t>(process.processId()), SIGINT);
    const bool ended = process.waitForFinished(20'000);
    tookMs = timer.elapsed();
    if (!ended) {
        process.kill();
        process.waitForFinished();
        return {-2, {}, "did not stop"};
    }
    err += process.readAllStandardError();
    const int code = process.exitStatus() == QProcess::NormalExit ? process.exitCode() : -3;
    return {code, QString::fromUtf8(process.readAllStandardOutput()), QString::fromUtf8(err)};
}

} // namespace lightloom::test

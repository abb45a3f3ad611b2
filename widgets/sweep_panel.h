// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "widgets/sweep_worker.h"
#include <QElapsedTimer>
#include <QWidget>
#include <array>
#include <map>
#include <optional>
#include <vector>

class QComboBox;
class QLabel;
class QLineEdit;
class QProgressBar;
class QPushButton;
class QSpinBox;
class QDoubleSpinBox;
class QTableWidget;

namespace lightloom {

class TradePlot;

/// The dock of measuring: bakes over values of one or two parameters, what each costs and how far off it is. A click on
/// a bake takes its parameters. Each method has its own parameters to vary and its own rows.
class SweepPanel final : public QWidget {
    Q_OBJECT
public:
    explicit SweepPanel(QWidget* parent = nullptr);
    /// Of the sweeps to come; rows of another scene go.
    void setScene(std::shared_ptr<const Scene> scene, const QString& file);
    void setMethod(Method method);          ///< whose parameters are varied; a sweep of another one goes on
    void setBase(const BakeParams& params); ///< values of what is not varied
    void holdFor(const QString& reason);    ///< others come first: said in place of progress; empty: go on

    [[nodiscard]] Method method() const { return method_; }
    [[nodiscard]] const std::vector<SweepRow>& rows() const { return shown().rows; } ///< in the order they are shown
    [[nodiscard]] bool isRunning() const { return isRunning_; }
    [[nodiscard]] QString stateText() const;
    [[nodiscard]] TradePlot& plot() const { return *plot_; }

Q_SIGNALS:
    void chosen(lightloom::BakeParams params);
    void ended();

private:
    struct AxisEdit {
        QComboBox* param;
        QLineEdit* values;
    };
    /// A method's last sweep, and what is chosen for the next.
    struct Measured {
        std::vector<SweepRow> rows;
        std::vector<std::string> wanted; ///< values of the axes, in order
        std::vector<SweepAxis> axes;     ///< of the sweep that runs or ran
        struct Choice {
            QString param, values;
        };
        std::array<std::optional<Choice>, 2> choices; ///< nothing: what is suggested
    };
    AxisEdit makeAxis(int number);
    void fillAxes(); ///< with the method's parameters
    void suggest(const AxisEdit& edit);
    void build();
    [[nodiscard]] const Measured& shown() const { return measured_.at(method_); }
    [[nodiscard]] Result<SweepPlan> plan() const;
    void tellPlan(); ///< how many bakes, or what is wrong
    void run();
    void take(const SweepProgress& progress);
    void takeRow(quint64 serial, const SweepRow& row);
    void end(quint64 serial, const QString& error, bool isCancelled);
    void choose(std::size_t row);
    void showRows();
    void save(bool asPlot);
    void write(const QString& file, bool asPlot);
    [[nodiscard]] QString sceneName() const;

    SweepWorker worker_;
    std::shared_ptr<const Scene> scene_;
    QString file_;
    BakeParams base_;
    Method method_ = Method::lightOctree, running_ = Method::lightOctree; ///< running: that runs or ran last
    std::map<Method, Measured> measured_{{method_, {}}};
    std::uint64_t serial_ = 0;
    bool isRunning_ = false;
    QString held_; ///< why it waits; empty: it does not
    QElapsedTimer told_;

    std::array<AxisEdit, 2> edits_{};
    QSpinBox* points_;
    QDoubleSpinBox* noise_;
    QPushButton *run_, *cancel_, *saveTable_, *savePlot_;
    QProgressBar* bar_;
    QLabel* state_;
    TradePlot* plot_;
    QTableWidget* table_;
};

} // namespace lightloom

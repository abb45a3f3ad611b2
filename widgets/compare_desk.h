// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "core/compare/legend.h"
#include "widgets/compare_worker.h"
#include <QTimer>
#include <optional>

class QAction;

namespace lightloom {

class ComparePanel;
class LegendStrip;
class Viewport;
class WipeHandle;

/// Holds the picture against the truth: asks for a reference of what the camera sees, asks again when camera, size or
/// lamps are others, and brings picture, errors and figures to where they are shown. A bake comes first.
class CompareDesk final : public QObject {
    Q_OBJECT
public:
    struct Parts {
        Viewport* viewport;
        ComparePanel* panel;
        WipeHandle* handle;
        LegendStrip* legend;
        QAction *reference, *wipe; ///< both checkable: on and off
    };
    CompareDesk(const Parts& parts, QObject* parent);

    void setScene(const QString& file); ///< forgets what was of another one
    void setMix(const Mix& mix);
    void lampsMoved(); ///< what was traced and judged is of another scene; light of this one will come
    /// The light that is shown; its mix must be the one of `setMix`.
    void setView(const BakeView& view);
    void setBaking(bool isBaking); ///< and not paused
    /// What is shown in place of light; nothing: light.
    void showErrors(std::optional<ErrorKind> kind);
    void modeChanged(); ///< the viewport's
    /// What colours over the picture mean, under it; beside what is said there of a made picture. Empty: nothing.
    void showNote(const QString& text, const std::optional<HeatmapStyle>& scale);
    /// In the legend, while the processor makes the picture; with the scale of what is shown of it in false colour.
    void showPictureState(const QString& text, const std::optional<HeatmapStyle>& scale);
    void showCuts(bool on); ///< in place of light: what the picture took, which needs no reference

    [[nodiscard]] bool isTracing() const;
    [[nodiscard]] const std::optional<ReferencePicture>& reference() const { return picture_; } ///< of this view
    [[nodiscard]] const std::shared_ptr<const ViewError>& errors() const { return error_; }     ///< likewise

Q_SIGNALS:
    void referenceShown();
    void errorsShown();
    void tracing(bool isBusy); ///< a reference is being traced, or will be as soon as it may

private:
    void viewChanged();
    void ask();
    void turn(bool on);
    void wantReference(); ///< something that is shown needs one
    void forgetErrors();
    void take(const ReferencePicture& picture);
    void take(const ErrorPicture& picture);
    void tellNames();
    void tellState();
    void tellLegend();

    Parts parts_;
    CompareWorker worker_;
    QTimer delay_;
    QString file_;
    Mix mix_;
    BakeView view_;
    std::optional<ErrorKind> shown_;
    QString problem_; ///< why no reference can be traced; empty: it can
    QString pictureState_, note_;
    std::optional<HeatmapStyle> pictureScale_, noteScale_;
    bool cutsShown_ = false;
    std::uint64_t serial_ = 0; ///< of the question that fits what is seen; 0: none was asked
    std::optional<ReferencePicture> picture_;
    std::shared_ptr<const ViewError> error_;
    int errorBlock_ = 1;      ///< ErrorPicture::block
    double judgedPart_ = 0.0; ///< of the work until the next one
    bool isBaking_ = false, wasTracing_ = false;
};

} // namespace lightloom

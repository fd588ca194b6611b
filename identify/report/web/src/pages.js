// Renderers by kind of section; the C++ side has the matching table in pages.cpp.
import { renderAddedVariable } from './pages/added_variable.js';
import { renderAutocorrelation } from './pages/autocorrelation.js';
import { renderBudget } from './pages/budget.js';
import { renderCertificateFigures, renderCertificateFiles, renderCertificateRecord, renderCertified, renderSignature } from './pages/certificate.js';
import { renderCircles } from './pages/circles.js';
import { renderComparison } from './pages/comparison.js';
import { renderComputation } from './pages/computation.js';
import { renderConfounding } from './pages/confounding.js';
import { renderDirectTests } from './pages/direct_tests.js';
import { renderDetectable } from './pages/detectable.js';
import { renderEvidence } from './pages/evidence.js';
import { renderFunctions } from './pages/functions.js';
import { renderGenericMap } from './pages/generic_map.js';
import { renderLocations } from './pages/locations.js';
import { renderNoiseModel } from './pages/noise_model.js';
import { renderNuisance } from './pages/nuisance.js';
import { renderObservability } from './pages/observability.js';
import { renderOutliers } from './pages/outliers.js';
import { renderPicture } from './pages/picture.js';
import { renderPlanErrors } from './pages/plan_errors.js';
import { renderPlanLayout } from './pages/plan_layout.js';
import { renderDiagonals, renderPositioning } from './pages/positioning.js';
import { renderResidualVariables } from './pages/residual_variables.js';
import { renderResidualVectors } from './pages/residual_vectors.js';
import { renderResiduals } from './pages/residuals.js';
import { renderResolution } from './pages/resolution.js';
import { renderRotaryAxes } from './pages/rotary_axes.js';
import { renderRotaryTables } from './pages/rotary_tables.js';
import { renderSetupResiduals } from './pages/setup_residuals.js';
import { renderSetups } from './pages/setups.js';
import { renderStory } from './pages/story.js';
import { renderSummary } from './pages/summary.js';
import { renderSurfaces } from './pages/surfaces.js';
import { renderUncertainties } from './pages/uncertainties.js';
import { renderValidation } from './pages/validation.js';
import { renderVolumeCauses } from './pages/volume_causes.js';
import { renderVolume } from './pages/volume.js';

export const renderers = {
  summary: renderSummary,
  functions: renderFunctions,
  locations: renderLocations,
  rotary_axes: renderRotaryAxes,
  surfaces: renderSurfaces,
  volume: renderVolume,
  residuals: renderResiduals,
  outliers: renderOutliers,
  setups: renderSetups,
  observability: renderObservability,
  resolution: renderResolution,
  nuisance: renderNuisance,
  computation: renderComputation,
  picture: renderPicture,
  story: renderStory,
  volume_causes: renderVolumeCauses,
  evidence: renderEvidence,
  confounding: renderConfounding,
  added_variable: renderAddedVariable,
  residual_variables: renderResidualVariables,
  residual_vectors: renderResidualVectors,
  generic_map: renderGenericMap,
  autocorrelation: renderAutocorrelation,
  detectable: renderDetectable,
  noise_model: renderNoiseModel,
  comparison: renderComparison,
  validation: renderValidation,
  circles: renderCircles,
  positioning: renderPositioning,
  diagonals: renderDiagonals,
  direct_tests: renderDirectTests,
  setup_residuals: renderSetupResiduals,
  uncertainties: renderUncertainties,
  budget: renderBudget,
  plan_layout: renderPlanLayout,
  plan_errors: renderPlanErrors,
  certified: renderCertified,
  certificate_figures: renderCertificateFigures,
  rotary_tables: renderRotaryTables,
  certificate_record: renderCertificateRecord,
  certificate_files: renderCertificateFiles,
  signature: renderSignature,
};

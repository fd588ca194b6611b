// Renderers by kind of section; the C++ side has the matching table in pages.cpp.
import { renderComputation } from './pages/computation.js';
import { renderFunctions } from './pages/functions.js';
import { renderLocations } from './pages/locations.js';
import { renderNuisance } from './pages/nuisance.js';
import { renderObservability } from './pages/observability.js';
import { renderOutliers } from './pages/outliers.js';
import { renderResiduals } from './pages/residuals.js';
import { renderResolution } from './pages/resolution.js';
import { renderSetups } from './pages/setups.js';
import { renderSummary } from './pages/summary.js';
import { renderVolume } from './pages/volume.js';

export const renderers = {
  summary: renderSummary,
  functions: renderFunctions,
  locations: renderLocations,
  volume: renderVolume,
  residuals: renderResiduals,
  outliers: renderOutliers,
  setups: renderSetups,
  observability: renderObservability,
  resolution: renderResolution,
  nuisance: renderNuisance,
  computation: renderComputation,
};

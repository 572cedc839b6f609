# Which tests run when, read by CTest: `ctest -L quick` takes under two minutes in all on two cores; `-L full` is every
# test but the nightly ones, what script/test runs; `-L nightly` is what .ci/nightly runs besides. A suite that is named
# here takes two seconds or more.
set(slow_suites
  AccuracyCommand Acquiring AgreementStudy All/BeamShapes Answers ApertureLosses AttenuatedBeam
  Bases/EachSetting BlockBootstrap CommandLine CommandLine/RandomBadLines CommandLine/RefusesBadInput ConeMean
  Conformance Custody Each/BadBoards Each/FastAgainstPlain Each/RecordIqRefuses Each/SetOptions Evaluator
  Extremes ExtremesCommand FailingCalls FastAgainstPlainAtRandom FiniteSamples Fit ImportProcess
  KnownError LevelSet LineCovariance MaternalLayer MeshImport Motions/TruthOfMovingFace MovedTissue
  Of/EachCall Of/EachCallOfSalvage OpenMouth PathsOfAnyBytes Phantoms/Calibration
  Phantoms/GlAgainstReference PictureBound PointScatterers PointTargetStudy Presets/Passes Progress RecordIq RecordReport
  RecordedSphere Recording Recordings Reference Renderer RepeatabilityStudy Rubbish RunReport Rungs
  Rungs/OnTheSimulator Rungs/PointsOnRung ScattererHdf5 Scatterers Scenes/MemoryOfRun Settings/EachSetting
  SimLink Speckle SpeckleSizeStudy SpeckleStudy Steps StreamCommand SurfaceFinder Tables TablesProgram
  TissueMap Tolerance Trade Truth Tune TurnedMesh VdbFile VdbImport Velocities/TruthOfMovingSphere
  Weeks/Biometry Weeks/FetalScene WithRecording WithScale Views/DepthPoints DepthToPoints PictureSides Hints
  Warnings EqualReports IncidenceCorrection Journal Surroundings MotorAngles MotorAngles/EachLaw RunWarnings StlImport
  Labels Landmarks PixelLabels Visibility)

set(nightly_suites Bases/IdleSweep)

# The labels of a suite of GoogleTest. CTest knows no IN_LIST.
function(tier_labels suite result)
  list(FIND nightly_suites "${suite}" nightly)
  if(NOT nightly EQUAL -1)
    set(${result} nightly PARENT_SCOPE)
    return()
  endif()
  list(FIND slow_suites "${suite}" slow)
  if(slow EQUAL -1)
    set(${result} quick full PARENT_SCOPE)
  else()
    set(${result} full PARENT_SCOPE)
  endif()
endfunction()

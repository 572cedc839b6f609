# Which tests run when, read by CTest: `ctest -L quick` takes under two minutes in all on two cores; `-L full` is every
# test but the nightly ones, what script/test runs; `-L nightly` is what .ci/nightly runs besides. A suite that is named
# here is not quick: it takes longer than a second or two.
set(slow_suites)
set(nightly_suites)

# The labels of a suite of GoogleTest.
function(tier_labels suite result)
  if(suite IN_LIST nightly_suites)
    set(labels nightly)
  elseif(suite IN_LIST slow_suites)
    set(labels full)
  else()
    set(labels quick full)
  endif()
  set(${result} "${labels}" PARENT_SCOPE)
endfunction()

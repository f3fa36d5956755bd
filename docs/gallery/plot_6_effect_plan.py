"""
What a run will do, before it runs
==================================

``mpmfw explain SCENE`` prints it; from Python the same is at hand as objects. A scene pays for what it calls
for, and for nothing else: an effect that is off registers no hook and allocates no array."""

import mpmfw
from mpmfw.runs import prediction
from mpmfw.runs.simulation import Simulation

simulation = Simulation(mpmfw.load_scene("rolling-cylinder-slip"))
for effect in simulation.effects:
    print(f"{'on ' if effect.on else 'off'}  {effect.name:34s} {effect.reason}")

# %%
# Who acts where in the time step, in the order of the calls:

for hook, plugins in simulation.hook_callers().items():
    if plugins:
        print(f"{hook:28s} {', '.join(plugins)}")

# %%
# What limits the time step:

for limit, owner in sorted(simulation.limits()):
    print(f"{1e6 * limit:8.1f} µs  {owner}")
print(f"the first step will be {1e6 * simulation.stable_step():.1f} µs long")

# %%
# Arrays of the plug-ins, the largest first:

arrays = sorted(simulation.state.arrays.items(), key=lambda item: -item[1].nbytes)
for name, array in arrays[:8]:
    print(f"{array.nbytes / 1024:8.0f} KiB  {name:32s} {array.shape}")

# %%
# The same scene without a contact algorithm: what the penalty contact calls for, and nothing else does.

other = Simulation(mpmfw.load_scene("rolling-cylinder-slip"), contact="none")
on_without = {effect.name for effect in other.effects if effect.on}
print(
    *(effect.name for effect in simulation.effects if effect.on and effect.name not in on_without), sep="\n"
)

# %%
# And what it is predicted to cost, from a trial of a few steps, which uses the simulation up:

cost = prediction.predict(simulation, [])
print(f"{cost.steps} steps, {cost.cpu_time:.2f} s CPU:")
for stage, seconds in cost.stages.items():
    print(f"  {stage:12s} {seconds:.2f} s")

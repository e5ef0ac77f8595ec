"""Plans a move, has a simulated axis follow it, holds and resumes it on the way, and plots what became of it.

    portamento-server & portamento-sim-axis &
    pip install './client/python[example]'
    python client/python/examples/plan_and_hold.py plan_and_hold.png
"""

import argparse

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

import portamento
from portamento.motion.v1 import sim_axis_pb2 as sim

# A motor of 12 kg with a load of 2 kg behind a spring: it swings at 46 Hz, and its servo follows within 10 µm.
MODEL = sim.AxisModel(
    axis="x",
    mechanics=sim.Mechanics(
        two_mass=sim.Mechanics.TwoMassLoad(motor_inertia=12, load_inertia=2, stiffness=1.43e5, damping=5.3),
        friction=sim.Mechanics.Friction(coulomb=3, viscous=5, static_friction=4, stribeck_velocity=0.005), max_effort=200),
    servo=sim.Servo(position_gain=80, velocity_gain=14_000, velocity_feedforward=1, acceleration_feedforward=1),
    encoder=sim.Encoder(resolution=1e-7))

parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
parser.add_argument("plot", nargs="?", default="plan_and_hold.png", help="where to draw it")
parser.add_argument("--server", default="127.0.0.1:50051", help="the planner, as host:port")
parser.add_argument("--axis", default="127.0.0.1:50052", help="the axis simulator, as host:port")
asked = parser.parse_args()

server, axis = portamento.Server(asked.server), portamento.SimAxis(asked.axis)
limits = portamento.Limits(velocity=0.25, acceleration=3, jerk=100)
plan = server.plan(portamento.Move("x", 0.2, limits))
print(f"planned: {plan.duration:.4f} s, certificate {'passed' if plan.certificate.passed else 'failed'}")

times, planned, commanded, error = [], [], [], []
with axis.track(plan, "python/x", [f"http://{asked.server}"], models=[MODEL]) as run:
    hold = axis.hold("python/x", not_before=300)
    print(f"holds from cycle {hold.effective_cycle}, rests from {hold.rest_cycle}")
    resume = axis.resume("python/x", not_before=hold.rest_cycle + 200)
    print(f"goes on from cycle {resume.effective_cycle}")
    for samples in run:
        for n in range(samples.cycles):
            time = (samples.first_cycle + n) * plan.cycle_time
            times.append(time)
            planned.append(plan.at(time)[0])
            commanded.append(samples.position[0][n])
            error.append(samples.following_error[0][n] * 1e6)
card = run.report.axes[0]
print(f"followed within {card.max_following_error * 1e6:.3g} µm")

figure, (above, below) = plt.subplots(2, 1, sharex=True, figsize=(8, 6))
above.plot(times, planned, "--", color="0.6", label="as planned")
above.plot(times, commanded, label="with hold and resume")
above.set_ylabel("Position [m]")
above.legend()
below.plot(times, error)
below.set_ylabel("Following error [µm]")
below.set_xlabel("Time [s]")
figure.savefig(asked.plot, dpi=120)
print(f"drawn: {asked.plot}")

#!/usr/bin/env python3
"""Trains the small object detector that the tests use, and exports it as ONNX.

    loci-evaluate detection --training-images /tmp/tables --tables 4000
    python3 train.py /tmp/tables household.onnx
    python3 train.py /tmp/tables household.onnx --start household.onnx --epochs 6

The committed model had ten of the first twenty epochs, and then these six.

Needs python3-torch, python3-pil and python3-onnx (for --start). The network has the output of YOLOv5: a row of x, y, width,
height, objectness and classes per cell, in pixels of the input (256 x 192). It is anchor-free: each cell of 8 pixels
predicts the object whose centre lies in it.
"""
import argparse
import pathlib
import time

import numpy
import torch
from PIL import Image
from torch import nn
from torch.nn import functional

WIDTH, HEIGHT, STRIDE = 256, 192, 8
COLUMNS, ROWS = WIDTH // STRIDE, HEIGHT // STRIDE


class Block(nn.Module):
    """Residual, with separable convolution."""

    def __init__(self, channels, dilation):
        super().__init__()
        self.depthwise = nn.Conv2d(channels, channels, 3, padding=dilation, dilation=dilation, groups=channels, bias=False)
        self.depthwise_norm = nn.BatchNorm2d(channels)
        self.pointwise = nn.Conv2d(channels, channels, 1, bias=False)
        self.pointwise_norm = nn.BatchNorm2d(channels)

    def forward(self, x):
        inner = functional.relu(self.depthwise_norm(self.depthwise(x)))
        return functional.relu(x + self.pointwise_norm(self.pointwise(inner)))


def convolution(inputs, outputs, stride):
    return nn.Sequential(nn.Conv2d(inputs, outputs, 3, stride, 1, bias=False), nn.BatchNorm2d(outputs), nn.ReLU())


class Detector(nn.Module):
    def __init__(self, classes):
        super().__init__()
        self.body = nn.Sequential(
            convolution(3, 12, 2), convolution(12, 24, 2), Block(24, 1), convolution(24, 56, 2),
            *[Block(56, dilation) for dilation in (1, 2, 1, 4, 1, 2, 1)])
        self.head = nn.Conv2d(56, 5 + classes, 1)
        nn.init.constant_(self.head.bias[4], -4)
        v, u = torch.meshgrid(torch.arange(ROWS), torch.arange(COLUMNS), indexing="ij")
        self.register_buffer("cells", torch.stack([u, v]).reshape(1, 2, -1).float())
        self.decode = False

    def forward(self, image):
        raw = self.head(self.body(image)).flatten(2)  # batch, 5 + classes, cells
        if not self.decode:
            return raw
        centre = (torch.sigmoid(raw[:, 0:2]) + self.cells) * STRIDE
        size = torch.exp(raw[:, 2:4]) * STRIDE
        rows = torch.cat([centre, size, torch.sigmoid(raw[:, 4:5])], 1).transpose(1, 2)
        return torch.cat([rows, torch.softmax(raw[:, 5:].transpose(1, 2), 2)], 2)

    def convolutions(self):
        """All of them in the order in which they run, each with its normalisation (the last has none)."""
        for module in self.body:
            if isinstance(module, Block):
                yield module.depthwise, module.depthwise_norm
                yield module.pointwise, module.pointwise_norm
            else:
                yield module[0], module[1]
        yield self.head, None

    def start_from(self, path):
        """Takes the weights of an exported model, whose normalisations are part of its convolutions."""
        import onnx
        from onnx import numpy_helper
        graph = onnx.load(str(path)).graph
        values = {tensor.name: torch.from_numpy(numpy_helper.to_array(tensor).copy()) for tensor in graph.initializer}
        nodes = [node for node in graph.node if node.op_type == "Conv"]
        for node, (convolution, norm) in zip(nodes, self.convolutions()):
            convolution.weight.data = values[node.input[1]]
            if norm is None:
                convolution.bias.data = values[node.input[2]]
                continue
            norm.bias.data = values[node.input[2]]
            norm.running_var.fill_(1 - norm.eps)

    def freeze_norms(self):
        for _, norm in self.convolutions():
            if norm is not None:
                norm.eval()


def load(folder):
    """All images, uint8, and boxes (class, x, y, width, height in cells)."""
    images, boxes = [], []
    for file in sorted((folder / "images").glob("*.jpg")):
        images.append(numpy.asarray(Image.open(file).resize((WIDTH, HEIGHT), Image.BILINEAR)).transpose(2, 0, 1))
        lines = (folder / "labels" / (file.stem + ".txt")).read_text().split("\n")
        rows = [[float(value) for value in line.split()] for line in lines if line]
        boxes.append(numpy.array(rows, numpy.float32).reshape(-1, 5) * [1, COLUMNS, ROWS, COLUMNS, ROWS])
    return torch.from_numpy(numpy.stack(images)), boxes


def batch_of(images, boxes, order, generator):
    """Images, mirrored and shifted at random, and per cell: the object's index, its class and its box."""
    pixels = images[order].float() / 255
    owner = torch.zeros(len(order), ROWS * COLUMNS, dtype=torch.bool)
    labels = torch.zeros(len(order), ROWS * COLUMNS, dtype=torch.long)
    targets = torch.zeros(len(order), 4, ROWS * COLUMNS)
    ignored = torch.zeros(len(order), ROWS * COLUMNS, dtype=torch.bool)
    for i, index in enumerate(order):
        mirrored = generator.random() < 0.5
        gain = torch.from_numpy(generator.uniform(0.8, 1.2, (3, 1, 1)).astype(numpy.float32))
        pixels[i] = (pixels[i].flip(2) if mirrored else pixels[i]) * gain
        for kind, x, y, width, height in boxes[index]:
            x = COLUMNS - x if mirrored else x
            # The cell of the centre is the object's; its neighbours near the centre may find it as well.
            for v in range(max(0, int(y) - 1), min(ROWS, int(y) + 2)):
                for u in range(max(0, int(x) - 1), min(COLUMNS, int(x) + 2)):
                    ignored[i, v * COLUMNS + u] = True
            u, v = min(int(x), COLUMNS - 1), min(int(y), ROWS - 1)
            cell = v * COLUMNS + u
            owner[i, cell] = True
            labels[i, cell] = int(kind)
            targets[i, :, cell] = torch.tensor([x, y, width, height])
    return pixels.clamp(0, 1), owner, labels, targets, ignored & ~owner


def overlap(a, b):
    """Generalised intersection over union of boxes (x, y, width, height)."""
    low = torch.maximum(a[:, :2] - a[:, 2:] / 2, b[:, :2] - b[:, 2:] / 2)
    high = torch.minimum(a[:, :2] + a[:, 2:] / 2, b[:, :2] + b[:, 2:] / 2)
    common = (high - low).clamp(min=0).prod(1)
    union = a[:, 2:].prod(1) + b[:, 2:].prod(1) - common
    hull = (torch.maximum(a[:, :2] + a[:, 2:] / 2, b[:, :2] + b[:, 2:] / 2)
            - torch.minimum(a[:, :2] - a[:, 2:] / 2, b[:, :2] - b[:, 2:] / 2)).prod(1)
    return common / union - (hull - union) / hull


def loss_of(raw, model, owner, labels, targets, ignored):
    objectness = raw[:, 4]
    weight = (~ignored).float()
    probability = torch.sigmoid(objectness)
    focal = torch.where(owner, (1 - probability) ** 2, probability ** 2)
    found = functional.binary_cross_entropy_with_logits(objectness, owner.float(), reduction="none") * focal * weight
    rows = raw.transpose(1, 2)[owner]
    cells = model.cells.expand(len(raw), -1, -1).transpose(1, 2)[owner]
    boxes = torch.cat([torch.sigmoid(rows[:, 0:2]) + cells, torch.exp(rows[:, 2:4].clamp(max=4))], 1)
    count = max(1, len(rows))
    place = (1 - overlap(boxes, targets.transpose(1, 2)[owner])).sum() / count
    kind = functional.cross_entropy(rows[:, 5:], labels[owner])
    return 4 * found.sum() / count + 2 * place + kind


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path, help="of loci-evaluate detection --training-images")
    parser.add_argument("model", type=pathlib.Path)
    parser.add_argument("--epochs", type=int, default=20)
    parser.add_argument("--start", type=pathlib.Path, help="go on from this model, with a quarter of the rate")
    given = parser.parse_args()
    torch.manual_seed(1)
    generator = numpy.random.default_rng(1)
    names = (given.folder / "data.yaml").read_text().split("names: [")[1].split("]")[0].split(", ")
    images, boxes = load(given.folder)
    model = Detector(len(names))
    rate = 4e-3
    if given.start:
        model.start_from(given.start)
        model.freeze_norms()
        rate /= 4
    print(f"{sum(p.numel() for p in model.parameters())} weights, {len(images)} images", flush=True)
    optimizer = torch.optim.AdamW(model.parameters(), lr=rate, weight_decay=1e-3)
    steps = given.epochs * (len(images) // 16)
    schedule = torch.optim.lr_scheduler.OneCycleLR(optimizer, rate, total_steps=steps, pct_start=0.1)
    begin = time.time()
    for epoch in range(given.epochs):
        order, total = generator.permutation(len(images)), 0.0
        for first in range(0, len(order) - 15, 16):
            pixels, *truth = batch_of(images, boxes, order[first:first + 16], generator)
            loss = loss_of(model(pixels), model, *truth)
            optimizer.zero_grad()
            loss.backward()
            nn.utils.clip_grad_norm_(model.parameters(), 5)
            optimizer.step()
            schedule.step()
            total += loss.item()
        print(f"epoch {epoch + 1}: loss {total / (len(order) // 16):.3f}, {time.time() - begin:.0f} s", flush=True)
        if (epoch + 1) % 2 == 0 or epoch + 1 == given.epochs:
            export(model, names, given.model)
            if given.start:
                model.freeze_norms()


def export(model, names, path):
    model.eval()
    model.decode = True
    torch.onnx.export(model, torch.zeros(1, 3, HEIGHT, WIDTH), str(path), opset_version=12, input_names=["images"],
                      output_names=["output0"], do_constant_folding=True)
    path.with_name("classes.txt").write_text("\n".join(names) + "\n")
    model.decode = False
    model.train()


if __name__ == "__main__":
    main()

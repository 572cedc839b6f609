// B-mode planes, with the surface of the picture in them.

const planeNames = ['Middle frame', 'Across the frames', 'At equal depth'];

class Planes {
  constructor(wants) {
    this.canvases = planeNames.map((name) => make('canvas', {width: 320, height: 320, role: 'img', 'aria-label': name}));
    const figures = this.canvases.map((canvas, index) => make('figure', {}, canvas, make('figcaption', {}, planeNames[index])));
    this.element = make('details', {class: 'planes', ontoggle: () => wants(this.element.open)},
      make('summary', {}, 'B-mode planes'), make('div', {class: 'row'}, ...figures));
  }

  async take({planes}, parts) {
    const images = await Promise.all(parts.map((part) => createImageBitmap(new Blob([part], {type: 'image/jpeg'}))));
    images.forEach((image, index) => {
      const context = this.canvases[index].getContext('2d');
      context.drawImage(image, 0, 0);
      image.close();
      context.strokeStyle = '#f0a030';
      context.lineWidth = 1.5;
      context.beginPath();
      for (const [x, y, toX, toY] of planes[index].lines) {
        context.moveTo(x + 0.5, y + 0.5);
        context.lineTo(toX + 0.5, toY + 0.5);
      }
      context.stroke();
    });
    this.element.dataset.ready = 'true';
  }
}

// The live connection: requests with answers, and whatever the studio tells.

export class Link {
  // `told` hears every message; `shapes` every shape or heat map; `online` whether there is a connection.
  constructor({ told, shapes, online }) {
    Object.assign(this, { told, shapes, online });
    this.waiting = new Map();
    this.next = 1;
    this.delay = 250;
    this.connect();
  }

  connect() {
    const address = new URL("ws", location.href);
    address.protocol = "ws:";
    this.socket = new WebSocket(address);
    this.socket.binaryType = "arraybuffer";
    this.socket.onopen = () => {
      this.delay = 250;
      this.online(true);
    };
    this.socket.onmessage = ({ data }) => {
      if (typeof data === "string") this.hear(JSON.parse(data));
      else this.shapes(data);
    };
    this.socket.onclose = () => {
      this.online(false);
      for (const { reject } of this.waiting.values()) reject(new Error("the connection was lost"));
      this.waiting.clear();
      setTimeout(() => this.connect(), this.delay);
      this.delay = Math.min(4000, this.delay * 2);
    };
  }

  hear(message) {
    if (message.type !== "reply") return this.told(message);
    const waiting = this.waiting.get(message.id);
    this.waiting.delete(message.id);
    if (!waiting) return undefined;
    return "error" in message ? waiting.reject(new Error(message.error)) : waiting.resolve(message.value);
  }

  // Asks the studio, by kind: a query, an edit or a command; what it answers, or why it does not.
  ask(kind, request) {
    if (this.socket.readyState !== WebSocket.OPEN) return Promise.reject(new Error("there is no connection"));
    const id = this.next++;
    this.socket.send(JSON.stringify({ id, [kind]: request }));
    return new Promise((resolve, reject) => this.waiting.set(id, { resolve, reject }));
  }

  tell(message) {
    if (this.socket.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(message));
  }
}

// Fetches the buffers of a shape.
export const fetchShape = async (name, hash) => {
  const answer = await fetch(`mesh/${name}?${hash}`);
  if (!answer.ok) throw new Error(`the ${name} cannot be loaded`);
  const bytes = await answer.arrayBuffer();
  const [nVertices, nTriangles, nEdges, hasNormals] = new Uint32Array(bytes, 0, 4);
  let at = 16;
  const take = (Type, n) => {
    const part = new Type(bytes, at, n);
    at += 4 * n;
    return part;
  };
  return {
    positions: take(Float32Array, 3 * nVertices),
    triangles: take(Uint32Array, 3 * nTriangles),
    edges: take(Uint32Array, 2 * nEdges),
    normals: hasNormals ? take(Float32Array, 3 * nVertices) : null,
  };
};

// Opens what the studio knows by name: the target that waits, a session that was set aside.
export const openKnown = (what, name) => post(what, name, null);

// Sends a file to be opened.
export const openFile = (role, file) => post(role, file.name, file);

const post = async (role, name, body) => {
  const answer = await fetch(`open/${role}/${encodeURIComponent(name)}`, { method: "POST", body });
  if (!answer.ok) throw new Error(answer.status === 413 ? "the file is larger than 512 MB" : await answer.text());
};
